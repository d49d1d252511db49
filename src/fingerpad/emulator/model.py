"""An emulator: its answers, and its file. It needs nothing but numpy and xarray."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any
from zipfile import BadZipFile

import numpy as np
import xarray as xr

from fingerpad.documents import SceneError
from fingerpad.emulator.basis import basis, cubic_weights, held, kernel, local_size, nearby, spread
from fingerpad.emulator.question import Knob, Question, ask, borders, looked_up, scaled
from fingerpad.files import write_atomically
from fingerpad.scenes.scene import Scene
from fingerpad.stimuli.motion import INSTANT

SCALARS = ("indentation_depth", "contact_width", "peak_pressure", "centre_pressure")
LOGARITHMIC = (*SCALARS, "estimated_error")
SLID = ("contact_centre", "tangential_share")
"""Of strokes: place of the middle of the pressure, over the depth; lateral over normal force."""
ENERGY = "energy_root"
UNITS = {
    "indentation_depth": "m",
    "contact_width": "m",
    "peak_pressure": "Pa",
    "centre_pressure": "Pa",
    "strain_energy_density": "Pa",
    "contact_pressure": "Pa",
    "force": "N/m",
    "tangential_force": "N/m",
    "stroke_distance": "m",
    "skin_displacement_x": "m",
    "skin_displacement_y": "m",
}
STRESSES = ("peak_pressure", "centre_pressure")
"""Quantities that grow with the modulus factor."""
PLACES = np.sin(np.pi / 2 * np.linspace(0, 1, 25))
"""Shares of the contact's half width, denser towards its edge."""
WHOLE = np.linspace(-1.25, 1.25, 61)
"""Likewise to both sides of the middle of the pressure of a stroke; it is nearer to one edge."""
NODES = 161
"""Skin nodes of an answer."""
ON_BORDER = 1e-8
"""m; a receptor this near a border belongs to the layer below, as the solver has it."""
FORMAT = 5
_CHUNK = 500
_PARTS = ("mean", "rows", "coefficients", "band", "scales", "missed")


def in_logarithm(name: str, turned: bool) -> bool:
    """Whether the logarithm of a quantity is emulated. Below a point of a body of revolution the
    energy falls with the square of the depth, so over many orders of magnitude.
    """
    return name in LOGARITHMIC or (turned and name.startswith(ENERGY))


@dataclass(frozen=True)
class Moments:
    """When quantities are known.

    Attributes
    ----------
    press : (n,) shares of the press's force.
    later : (m,) times of the hold, s, or ways of the slide, m.
    slid : whether the second leg is a slide.
    """

    press: np.ndarray
    later: np.ndarray
    slid: bool = False

    def __len__(self) -> int:
        return len(self.press) + len(self.later)

    @property
    def scalars(self) -> tuple[str, ...]:
        """Names of `SCALARS` that are emulated: under a stroke the middle may lose contact."""
        return SCALARS[:3] if self.slid else SCALARS

    @property
    def places(self) -> np.ndarray:
        """Shares of the half width, from the middle, at which pressure is emulated."""
        return WHOLE if self.slid else PLACES

    def even(self, later: np.ndarray) -> np.ndarray:
        """The scale in which the second leg is interpolated."""
        return np.abs(later) if self.slid else held(later)

    def weights(self, share: np.ndarray, later: np.ndarray) -> np.ndarray:
        """Weights (k, moments) of the values at all moments: at a share of the press while `later`
        is 0, in the second leg where it is not.
        """
        found, n = np.zeros((len(share), len(self))), len(self.press)
        in_press = np.asarray(later) == 0
        press = cubic_weights(np.log(self.press), np.log(np.asarray(share)[in_press]))
        found[in_press, :n] = press
        if not in_press.all():
            grid = np.concatenate([[0.0], self.even(self.later)])
            at = self.even(np.asarray(later)[~in_press])
            found[~in_press, n - 1 :] = cubic_weights(grid, at)
        return found


@dataclass(frozen=True)
class Group:
    """The coefficients of one quantity.

    The quantities are `LOGARITHMIC` ones; ``pressure_shape``, pressure over the mean pressure at
    `PLACES`; ``skin_displacement_x`` and ``_y`` over the depth; ``energy_root_<depth>_<layer>``,
    the root of the strain energy density over the line load at receptors of a depth, counted from
    0, in scenes in which a layer holds them: it jumps where layers meet.

    Attributes
    ----------
    shape : (...) of the quantity, moments first.
    mean, rows, band : (outputs,), (parts, outputs), (outputs,) mean, principal components, and the
        half width of the band where scenes are missed as much as anywhere; in the logarithm where
        that is emulated.
    coefficients : (terms, parts).
    scales : (knobs,) lengths of the Gaussian process.
    missed : (scenes,) by how much each scene is missed by the others, over what is usual; NaN where
        it has not the quantity. Around a place it is what the band is multiplied by.
    """

    shape: tuple[int, ...]
    mean: np.ndarray
    rows: np.ndarray
    coefficients: np.ndarray
    band: np.ndarray
    scales: np.ndarray
    missed: np.ndarray

    def folded(self, weights: np.ndarray | None) -> tuple[np.ndarray, np.ndarray]:
        """Mean and components of the quantity at weighted moments: (m,), (parts, m)."""
        mean, rows = self.mean, self.rows
        if weights is not None:
            mean = np.tensordot(weights, mean.reshape(self.shape), 1).ravel()
            rows = self.rows.reshape(-1, *self.shape)
            rows = np.einsum("km,pm...->pk...", weights, rows).reshape(len(self.rows), -1)
        return mean, rows

    def at(self, terms: np.ndarray, rows: np.ndarray) -> np.ndarray:
        """What components (parts, m) add to the mean at terms (n, terms): (n, m); the
        products are taken in the order that is less work.
        """
        (n, many), (parts, m) = terms.shape, rows.shape
        if n * parts * (many + m) < many * m * (parts + n):
            return (terms @ self.coefficients) @ rows
        return terms @ (self.coefficients @ rows)


@dataclass(frozen=True, repr=False)
class Emulator:
    """What a sweep's scenes answer, between them; see `fingerpad.emulate`.

    Attributes
    ----------
    knobs : list of Knob
        The sweep's keys, and the box.
    base : dict
        The sweep's scene.
    moments : Moments
        When quantities are known.
    grids : dict
        Arcs of the skin and its places at rest; depths and offsets of the receptors; m.
    powers : numpy.ndarray
        (polynomials, knobs) degrees of the trend.
    centres : numpy.ndarray
        (scenes, knobs) where the sweep's scenes lie, from -1 to 1.
    groups : dict
        Quantity -> `Group`.
    about : dict
        Provenance of the sweep, its number of scenes, and ``held_out``, the errors of a tenth.

    Examples
    --------
    >>> import fingerpad, tempfile
    >>> press = {"stimulus": {"shape": "flat"}, "motion": [{"press_to_force": "20 gf"}],
    ...          "accuracy": "draft"}
    >>> over = {"motion[0].press_to_force": {"range": ["10 gf", "40 gf"], "count": 8}}
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     _ = fingerpad.sweep(press, over, out=folder, histories=True)
    ...     pad = fingerpad.emulate(folder)
    >>> isinstance(pad, fingerpad.Emulator), [knob.name for knob in pad.knobs]
    (True, ['press_to_force'])
    >>> pad.predict(press).indentation_depth.units
    'm'
    """

    knobs: list[Knob]
    base: Mapping[str, Any]
    moments: Moments
    grids: Mapping[str, np.ndarray]
    powers: np.ndarray
    centres: np.ndarray
    groups: Mapping[str, Group]
    about: Mapping[str, Any]

    def __repr__(self) -> str:
        box = (f"{k.name} {k.shown(k.low)} to {k.shown(k.high)}" for k in self.knobs)
        return f"Emulator({len(self.centres)} scenes; {', '.join(box)})"

    def terms(self, points: np.ndarray, scales: np.ndarray) -> np.ndarray:
        """Terms (n, polynomials + scenes) at points (n, knobs), SI: the trend's polynomials, and
        the covariance of these lengths with each scene of the sweep.
        """
        at = scaled(self.knobs, points)
        return np.hstack([basis(at, self.powers), kernel(at, self.centres, scales)])

    def values(
        self,
        points: np.ndarray,
        names: tuple[str, ...] | None = None,
        weights: np.ndarray | None = None,
    ) -> dict[str, np.ndarray]:
        """Quantities at many points.

        Parameters
        ----------
        points
            (n, knobs), SI, at a modulus factor of 1. They are not compared with the box.
        names
            Of the quantities; all without.
        weights
            (k, moments) as `Moments.weights` gives them; all moments without.

        Returns
        -------
        dict
            Name -> (n, k, ...) values, SI.

        Raises
        ------
        ValueError
            Points have another shape, or a name is none of the quantities.
        """
        names, points = self.quantities if names is None else names, np.asarray(points, float)
        if points.ndim != 2 or points.shape[1] != len(self.knobs):
            keys = ", ".join(knob.key for knob in self.knobs)
            raise ValueError(f"points: has shape {points.shape}; allowed: a row each of {keys}")
        unknown = {names} if isinstance(names, str) else {*names} - {*self.quantities, *self.groups}
        if unknown:
            allowed = f"a tuple of {', '.join(self.quantities)}"
            raise ValueError(f"names: {', '.join(sorted(unknown))}: is unknown; allowed: {allowed}")
        if ENERGY in names:
            layers = self.layers(points)
            pieces = tuple(n for n, (d, layer) in self.pieces.items() if layer in layers[:, d])
            others = tuple(name for name in names if name != ENERGY)
            found = self.values(points, (*others, *pieces), weights)
            return self._joined(points, {name: found[name] for name in pieces}) | {
                name: found[name] for name in others
            }
        folded = {
            name: self.groups[name].folded(None if name == "estimated_error" else weights)
            for name in names
        }
        parts: dict[str, list[np.ndarray]] = {name: [] for name in names}
        for start in range(0, len(points), _CHUNK):
            some, known = points[start : start + _CHUNK], {}
            for name, (mean, rows) in folded.items():
                group = self.groups[name]
                alike = group.scales.tobytes()
                if alike not in known:
                    known[alike] = self.terms(some, group.scales)
                value = mean + group.at(known[alike], rows)
                parts[name].append(np.exp(value) if in_logarithm(name, self.turned) else value)
        shapes = {n: (-1, *self.groups[n].shape) for n in names}
        if weights is not None:
            wanted = (n for n in names if n != "estimated_error")
            shapes |= {n: (-1, len(weights), *self.groups[n].shape[1:]) for n in wanted}
        return {n: np.concatenate(p).reshape(shapes[n]) for n, p in parts.items()}

    @property
    def quantities(self) -> tuple[str, ...]:
        """Names of what is emulated; the parts of ``energy_root`` count once."""
        return (*(name for name in self.groups if name not in self.pieces), ENERGY)

    @property
    def turned(self) -> bool:
        """Whether it is of bodies of revolution."""
        return self.base.get("kinematics") == "axisymmetric"

    @cached_property
    def pieces(self) -> dict[str, tuple[int, int]]:
        """Name of each part of ``energy_root`` -> its depth, counted from 0, and its layer."""
        parts = (name.rsplit("_", 2) for name in self.groups if name.startswith(ENERGY))
        return {f"{ENERGY}_{depth}_{layer}": (int(depth), int(layer)) for _, depth, layer in parts}

    def layers(self, points: np.ndarray) -> np.ndarray:
        """The layer (n, depths), counted from 0 at the skin, that holds receptors at points (n,
        knobs).
        """
        points, column = np.asarray(points, float), {k.key: i for i, k in enumerate(self.knobs)}
        depths = np.unique(self.grids["receptor_depth"])
        found = np.zeros((len(points), len(depths)), int)
        for keys in borders(self.base):
            at = sum(
                points[:, column[key]] if key in column else looked_up(self.base, key)
                for key in keys
            )
            found += np.reshape(at, (-1, 1)) < depths + ON_BORDER
        return found

    def _joined(self, points: np.ndarray, parts: Mapping[str, np.ndarray]) -> dict[str, np.ndarray]:
        """``energy_root`` (n, ..., receptors) of its parts (n, ..., offsets); NaN where scenes were
        too few to fit one.
        """
        depths, which = np.unique(self.grids["receptor_depth"], return_inverse=True)
        layers = self.layers(points)
        some = next(iter(parts.values()), np.empty((0, len(self.moments), 0)))
        found = np.full((len(points), *some.shape[1:-1], len(which)), np.nan)
        for name, value in parts.items():
            depth, layer = self.pieces[name]
            rows = np.flatnonzero(layers[:, depth] == layer)
            found[np.ix_(rows, *map(np.arange, found.shape[1:-1]), which == depth)] = value[rows]
        return {ENERGY: found}

    def band(self, name: str, points: np.ndarray) -> np.ndarray:
        """Half width (n, ...) of the band of a quantity at points (n, knobs), or of its logarithm
        where that is emulated: a conformal band, wider where scenes nearby are missed by more (Lei
        and others 2018, section 5.2).
        """
        return self._band(name, points, nearby(scaled(self.knobs, points), self.centres))

    def _band(self, name: str, points: np.ndarray, near: np.ndarray) -> np.ndarray:
        if name == ENERGY:
            bands = {piece: self._band(piece, points, near) for piece in self.pieces}
            return self._joined(points, bands)[ENERGY]
        group = self.groups[name]
        wider = local_size(near, group.missed)
        return np.multiply.outer(wider, group.band.reshape(group.shape))

    def predict(
        self, scene: Scene | str | Path | Mapping[str, Any], extrapolate: bool = False
    ) -> xr.Dataset:
        """The history that a scene would have.

        Parameters
        ----------
        scene
            A scene, its file, or a dictionary. It may differ from the sweep's in the sweep's keys,
            in a common factor of all moduli, and in a shorter hold or slide. Its accuracy is not
            looked at.
        extrapolate
            Answer outside the box too. The band is then NaN: nothing is known of it.

        Returns
        -------
        xarray.Dataset
            Variables of a history, with its names and units. ``<name>_error`` is the half width of
            the band that held 95 % of the scenes left out of the fit. The attribute
            ``estimated_error`` is the finite element error on top, relative.

        Raises
        ------
        SceneError
            The scene is another than the sweep's, or outside its box; one line.
        """
        asked = ask(scene, self.base, self.knobs)
        if asked.outside and not extrapolate:
            raise SceneError(asked.outside[0])
        return self._history(asked)

    def _history(self, asked: Question) -> xr.Dataset:
        share, later, time, leg = self._times(asked)
        weights, slid = self.moments.weights(share, later), self.moments.slid
        found = {k: v[0] for k, v in self.values(asked.point[None], None, weights).items()}
        keys = {k.key: v for k, v in zip(self.knobs, asked.point, strict=True)}
        force = keys.get("motion[0].press_to_force", self.base["motion"][0]["press_to_force"])
        load = share * force * asked.modulus / self.base["specimen"]["contact_length"]
        depth, half = found["indentation_depth"], found["contact_width"] / 2
        grids, turned = self.grids, self.turned
        arc = np.linspace(0 if turned else -1, 1, NODES) * grids["arc"][-1]
        near, side = (arc, 1.0) if slid else (np.abs(arc), np.sign(arc))
        skin = {n: np.interp(near, grids["arc"], grids[n]) for n in ("skin_x", "skin_y")}
        skin["skin_x"] *= side
        data: dict[str, Any] = {"force": ("time", load), "leg": ("time", leg)}
        bands, centre = self._bands(weights, asked), np.zeros(len(time))
        if slid:
            centre = found["contact_centre"] * depth
            data["stroke_distance"] = "time", later
            data["tangential_force"] = "time", load * found["tangential_share"]
            data["tangential_force_error"] = "time", load * bands["tangential_share"]
        if not slid:
            found["peak_pressure"] = np.maximum(found["peak_pressure"], found["centre_pressure"])
        for name in self.moments.scalars:
            values = found[name] * (asked.modulus if name in STRESSES else 1.0)
            data[name] = "time", values
            data[f"{name}_error"] = "time", values * bands[name]
        wanted = self._receptors(asked)
        root, width = found["energy_root"][:, wanted], bands["energy_root"][:, wanted]
        width = width * root if in_logarithm(ENERGY, turned) else width
        size = asked.modulus * ((load / asked.modulus) ** 2)[:, None]
        energy, band = size * root**2, size * width * (2 * np.abs(root) + width)
        data["strain_energy_density"] = ("time", "receptor"), energy
        data["strain_energy_density_error"] = ("time", "receptor"), band
        for axis in "xy":
            name = f"skin_displacement_{axis}"
            rows = found[name] * depth[:, None]
            moved = np.array([np.interp(near, grids["arc"], row) for row in rows])
            data[name] = ("time", "skin_node"), moved * (side if axis == "x" else 1.0)
        place = skin["skin_x"] + data["skin_displacement_x"][1] - centre[:, None]
        place = (place if slid else np.abs(place)) / half[:, None]
        place = np.where(skin["skin_y"] > 0, place, 2.0)
        mean = load / spread(half, turned)
        for name, rows in (("", found["pressure_shape"]), ("_error", bands["pressure_shape"])):
            known = zip(place, rows, strict=True)
            shown = [np.interp(s, self.moments.places, r, right=0.0) for s, r in known]
            pressure = np.maximum(shown, 0.0) * mean[:, None]
            data[f"contact_pressure{name}"] = ("time", "skin_node"), pressure
        return self._labelled(data, time, arc, skin, wanted, found["estimated_error"], asked)

    def _times(self, asked: Question) -> tuple[np.ndarray, ...]:
        """Share of the force, time since the press, time and leg of the outputs after the first."""
        press, later = self.moments.press, self.moments.later
        last = 0.0 if asked.later is None else asked.later
        own = np.abs(later) < abs(last) * (1 - 1e-9)
        after = np.append(later[own], [last] if last else [])
        keys = {k.key: v for k, v in zip(self.knobs, asked.point, strict=True)}
        leg = self.base["motion"][0]
        force = keys.get("motion[0].press_to_force", leg["press_to_force"])
        rate = keys.get("motion[0].rate", leg.get("rate"))
        top = force / rate if rate else 0.0
        share = np.concatenate([press, np.ones(len(after))])
        since = np.concatenate([np.zeros(len(press)), after])
        number = np.concatenate([np.zeros(len(press), int), np.ones(len(after), int)])
        if not self.moments.slid:
            return share, since, top * share + since, number
        speed = keys.get("motion[1].speed", self.base["motion"][1].get("speed"))
        moved = np.abs(since) / speed if speed else INSTANT * np.arange(len(since))
        return share, since, top * share + moved, number

    def _bands(self, weights: np.ndarray, asked: Question) -> dict[str, np.ndarray]:
        """Half width of the band of each quantity at weighted moments, relative where it is
        emulated in its logarithm; NaN where nothing is known.
        """
        near = np.maximum(weights, 0.0)
        near /= near.sum(axis=1, keepdims=True)
        found, known = {}, np.nan if asked.outside else 1.0
        points = asked.point[None]
        scenes = nearby(scaled(self.knobs, points), self.centres)
        for name in self.quantities:
            if name == "estimated_error":
                continue
            band = np.tensordot(near, self._band(name, points, scenes)[0], 1)
            found[name] = known * (np.expm1(band) if in_logarithm(name, self.turned) else band)
        return found

    def _receptors(self, asked: Question) -> list[int]:
        """Indices of the receptors that a scene asks for."""
        places = list(zip(self.grids["receptor_depth"], self.grids["receptor_offset"], strict=True))
        found = []
        for depth, offset in asked.receptors:
            aimed = offset if self.moments.slid else abs(offset)
            near = [
                k
                for k, (d, o) in enumerate(places)
                if abs(d - depth) < 1e-7 and abs(o - aimed) < 1e-7
            ]
            if not near:
                depths = ", ".join(f"{1e6 * d:g}" for d in dict.fromkeys(p[0] for p in places))
                offsets = ", ".join(f"{1e3 * o:g}" for o in dict.fromkeys(p[1] for p in places))
                raise SceneError(
                    f"outputs.receptors: ({1e6 * depth:g} um, {1e3 * offset:g} mm) is outside the "
                    f"emulator; allowed: depths of {depths} um at offsets of {offsets} mm"
                )
            found.append(near[0])
        return found

    def _labelled(self, data, time, arc, skin, wanted, error, asked: Question) -> xr.Dataset:
        """The dataset, with the untouched pad as its first output."""
        started = {}
        for name, (dims, values) in data.items():
            rest = np.concatenate([np.zeros((1, *values.shape[1:]), values.dtype), values])
            unit = UNITS.get(name.removesuffix("_error"), "1")
            if name == "force" and self.turned:
                unit = "N"
            started[name] = dims, rest, {"units": unit}
        offsets = self.grids["receptor_offset"][wanted]
        coordinates = {
            "time": ("time", np.append(0.0, time), {"units": "s"}),
            "skin_arc": ("skin_node", arc, {"units": "m"}),
            "skin_x": ("skin_node", skin["skin_x"], {"units": "m"}),
            "skin_y": ("skin_node", skin["skin_y"], {"units": "m"}),
            "receptor_depth": ("receptor", self.grids["receptor_depth"][wanted], {"units": "m"}),
            "receptor_offset": ("receptor", offsets, {"units": "m"}),
        }
        attributes = {
            "title": "fingerpad emulator",
            "scene": json.dumps(asked.scene.canonical()),
            "estimated_error": float(error[0]),
            "outside": "; ".join(asked.outside),
            "modulus_factor": asked.modulus,
            "provenance": self.about.get("provenance", ""),
        }
        return xr.Dataset(started, coordinates, attributes)

    # --- the file ---------------------------------------------------------------------------------

    def save(self, path: str | Path) -> None:
        """Write a file that `load_emulator` reads: numpy's npz, without pickle.

        ``about`` is JSON text: format, knobs, scene, slid, shapes, provenance. Arrays are
        ``press``, ``later``, ``powers``, ``centres``, ``grid_<name>``, and of each quantity
        ``<name>_mean``, ``_rows``, ``_coefficients``, ``_band``, ``_scales`` and ``_missed``.
        """
        about = {
            "format": FORMAT,
            "knobs": [knob.record() for knob in self.knobs],
            "base": self.base,
            "slid": self.moments.slid,
            "shapes": {name: list(group.shape) for name, group in self.groups.items()},
            "about": self.about,
        }
        arrays: dict[str, Any] = {"about": np.array(json.dumps(about))}
        arrays |= {"press": self.moments.press, "later": self.moments.later}
        arrays |= {"powers": self.powers, "centres": self.centres}
        arrays |= {f"grid_{name}": grid for name, grid in self.grids.items()}
        for name, group in self.groups.items():
            for part in _PARTS:
                arrays[f"{name}_{part}"] = getattr(group, part)

        def write(partial: Path) -> None:
            with partial.open("wb") as file:
                np.savez_compressed(file, **arrays)

        write_atomically(path, write)


def load_emulator(file: str | Path) -> Emulator:
    """Read the emulator that a file holds.

    Parameters
    ----------
    file
        As ``fingerpad emulate`` and `Emulator.save` write it.

    Raises
    ------
    SceneError
        It is no such file; one line.

    Examples
    --------
    >>> import fingerpad
    >>> fingerpad.load_emulator("none.emulator")
    Traceback (most recent call last):
    fingerpad.documents.SceneError: none.emulator: is not there; allowed: the file of an emulator
    """
    try:
        with np.load(file, allow_pickle=False) as found:
            arrays = {name: found[name] for name in found.files}
        about = json.loads(str(arrays.pop("about")))
        if about["format"] != FORMAT:
            raise ValueError("another format")
        groups = {
            name: Group(
                tuple(shape),
                *(arrays[f"{name}_{part}"] for part in _PARTS),
            )
            for name, shape in about["shapes"].items()
        }
        grids = {k.removeprefix("grid_"): v for k, v in arrays.items() if k.startswith("grid_")}
        knobs = [Knob(**knob) for knob in about["knobs"]]
        moments = Moments(arrays["press"], arrays["later"], about["slid"])
        places = arrays["powers"], arrays["centres"]
        return Emulator(knobs, about["base"], moments, grids, *places, groups, about["about"])
    except FileNotFoundError:
        raise SceneError(f"{file}: is not there; allowed: the file of an emulator") from None
    except (OSError, ValueError, KeyError, TypeError, EOFError, BadZipFile):
        raise SceneError(f"{file}: holds no emulator; allowed: what emulate writes") from None
