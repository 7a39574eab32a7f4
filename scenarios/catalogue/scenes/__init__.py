"""Scenes of rigid bodies as users of engines write them, whose truth is a closed form."""
