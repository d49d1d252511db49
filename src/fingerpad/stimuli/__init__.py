"""What touches the pad: rigid profiles as signed distances, and motion programmes."""
