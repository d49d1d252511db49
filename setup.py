"""Gives a built package a copy of what a clone has in config and workflow."""

from pathlib import Path

from setuptools import setup
from setuptools.command.build_py import build_py

COPIES = {"specimens": "config/specimens/*.yaml", "": "workflow/rules/sweeps.smk"}
"""Folder below fingerpad/built_in (`fingerpad.files.BUILT_IN`) -> the files that go there."""


class BuildWithCopies(build_py):
    """Also copies specimens and the rules of sweeps."""

    def _get_data_files(self):
        target = Path(self.build_lib, "fingerpad", "built_in")
        copies = []
        for folder, pattern in COPIES.items():
            files = sorted(Path().glob(pattern))
            names = [file.name for file in files]
            copies.append(("fingerpad", str(files[0].parent), str(target / folder), names))
        return [*super()._get_data_files(), *copies]


setup(cmdclass={"build_py": BuildWithCopies})
