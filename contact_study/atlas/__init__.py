"""The contact atlas: a space-filling design of adhesive rough contacts, their loops, and one dataset of all of them.

``design`` draws conditions, ``loops`` turns them into studies and runs them, ``collection`` joins the datasets, and
``validation`` checks them. Solvers, observables and theories are those of the campaign.
"""
