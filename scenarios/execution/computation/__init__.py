"""What a task's result is computed by: the steady state, the motion, the period beside a law; in this process."""
