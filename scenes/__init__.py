"""What there is: cameras, lights, materials, targets, motions, scenarios, and the data set that holds their pictures."""
