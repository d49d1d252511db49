"""What people look at: the style of pictures, and files written whole. Knows nothing of what it
publishes.
"""
