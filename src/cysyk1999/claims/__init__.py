"""What the thesis states, judged by what is simulated."""
