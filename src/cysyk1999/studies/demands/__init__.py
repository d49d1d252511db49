"""What accuracy costs, how hard cases end, what effects change: a picture each."""
