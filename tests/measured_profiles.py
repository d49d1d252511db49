"""Thirty measured profiles and what they were measured of: shapes in mm, sampled with noise and
rounding as instruments do it.
"""

import numpy as np


def cylinder(radius):
    def shape(x):
        return radius - np.sqrt(np.maximum(radius**2 - x**2, 0))

    return shape, min(0.97 * radius, 4.0)


def edge(radius, width=6.0, tilt=0.0):
    """A face with rounded edges: a coin's edge, a bar."""

    def shape(x):
        over = np.clip(np.abs(x) - width / 2 + radius, 0, 0.98 * radius)
        beyond = np.maximum(np.abs(x) - width / 2 + 0.02 * radius, 0)
        return radius - np.sqrt(radius**2 - over**2) + 4 * beyond + tilt * x

    return shape, width / 2 + 0.2


def dots(height, diameter, *places):
    """Embossed dots, of a cosine's form, under a plate."""

    def shape(x):
        out = np.zeros_like(x)
        for place in places:
            near = np.clip((x - place) / (diameter / 2), -1, 1)
            out -= height / 2 * (1 + np.cos(np.pi * near))
        return out

    return shape, 5.0


def texture(amplitude, wavelength, radius=None):
    def shape(x):
        return amplitude * np.cos(2 * np.pi * x / wavelength) + (
            x**2 / 2 / radius if radius else 0.0
        )

    return shape, 5.0


SHAPES = {
    "cylinder 1.5": cylinder(1.5),
    "cylinder 2.5": cylinder(2.5),
    "cylinder 5": cylinder(5.0),
    "cylinder 20": cylinder(20.0),
    "plate": cylinder(1e6),
    "coin's edge": edge(0.4, 2.0),
    "bar": edge(0.6, 3.0),
    "tilted bar": edge(0.6, 4.0, 0.05),
    "dot": dots(0.5, 2.0, 0.0),
    "two dots": dots(0.4, 2.0, -1.5, 1.5),
    "texture": texture(-0.02, 2.0),
    "textured cylinder": texture(-0.01, 1.5, 6.0),
}


def spectrum(rng, count, spacing, slope, longest):
    """Gaussian noise of rms 1 whose power falls like wavenumber ** -slope below a longest
    wavelength (mm).
    """
    wave = np.fft.rfftfreq(count, spacing)
    power = np.where(wave > 1 / longest, np.maximum(wave, 1 / longest) ** (-slope / 2), 0.0)
    noise = np.fft.irfft(power * np.fft.rfft(rng.normal(size=count)), count)
    return noise / noise.std()


INSTRUMENTS = [
    line.split(", ")
    for line in """
cylinder 1.5, 0.005, 0.0005, 0, 6
cylinder 2.5, 0.005, 0.0005, 0, 6
cylinder 2.5, 0.024, 0.0005, 0, 6
cylinder 2.5, 0.005, 0, 0, 3
cylinder 2.5, 0.0048, 0.002, 0, 6
cylinder 2.5, 0.005, 0.001, 1, 4
cylinder 2.5, 0.005, 0.001, 2, 5
cylinder 5, 0.001, 0.0005, 0, 6
cylinder 5, 0.002, 0, 0, 3
cylinder 5, 0.01, 0.001, 1, 6
cylinder 20, 0.005, 0.0005, 0, 4
cylinder 20, 0.005, 0.0005, 2, 4
plate, 0.005, 0.0005, 0, 6
plate, 0.001, 0.0005, 1, 5
plate, 0.01, 0.001, 2, 3
coin's edge, 0.005, 0.0005, 0, 6
coin's edge, 0.004, 0, 0, 3
coin's edge, 0.01, 0.001, 1, 6
bar, 0.005, 0.0005, 0, 6
bar, 0.02, 0.0005, 2, 4
tilted bar, 0.005, 0.0005, 0, 6
dot, 0.005, 0.0005, 0, 6
dot, 0.005, 0, 0, 3
dot, 0.002, 0.001, 1, 4
two dots, 0.005, 0.0005, 0, 6
two dots, 0.01, 0.001, 2, 5
texture, 0.005, 0.0005, 0, 6
texture, 0.005, 0, 0, 3
textured cylinder, 0.005, 0.0005, 0, 6
textured cylinder, 0.01, 0.001, 1, 5
""".strip().splitlines()
]
"""Shape, spacing mm, rms of the noise mm, slope of its spectrum, digits after the point of a
millimetre.
"""


def measured(number):
    """x, y (n,) m as an instrument reports them, and y as it is, of one of the thirty."""
    name, *numbers = INSTRUMENTS[number]
    spacing, noise, slope, digits = map(float, numbers)
    shape, half = SHAPES[name]
    count = 2 * round(half / spacing) + 1
    x = np.linspace(-half, half, count)
    rng = np.random.default_rng(number)
    y = shape(x) + (noise * spectrum(rng, count, spacing, slope, 0.2) if noise else 0.0)
    # ends of steps are sampled too coarsely to differ after rounding
    return 1e-3 * np.round(x, 6), 1e-3 * np.round(y, int(digits)), 1e-3 * shape(x)
