"""What is run and what is compared: questions to engines, agreement, the paper's figure 3."""
