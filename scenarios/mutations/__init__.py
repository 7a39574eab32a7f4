"""What the suite would find out: engines that are wrong on purpose, and the gates that they have to pass."""
