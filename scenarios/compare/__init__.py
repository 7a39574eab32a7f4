"""What has changed from one store or configuration to another."""
