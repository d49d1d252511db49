"""How stable the method is in hard cases."""
