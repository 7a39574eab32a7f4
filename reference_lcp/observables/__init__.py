"""What is read from a motion: transmittance, stick and slip, transitions, energy."""
