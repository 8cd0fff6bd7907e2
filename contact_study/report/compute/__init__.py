"""What is made of the datasets: states found again, deviations, regime numbers, curves of the figures."""
