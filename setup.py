"""What a clone reads beside the package, and of which a built package carries a copy: specimens, and the rules of sweeps."""

from pathlib import Path

from setuptools import setup
from setuptools.command.build_py import build_py


class BuildWithSpecimens(build_py):
    """Also takes config/specimens and workflow/rules/sweeps.smk, into fingerpad/built_in (`fingerpad.files.BUILT_IN`)."""

    def _get_data_files(self):
        names = sorted(path.name for path in Path("config/specimens").glob("*.yaml"))
        target = Path(self.build_lib, "fingerpad", "built_in", "specimens")
        rules = ("fingerpad", "workflow/rules", str(target.parent), ["sweeps.smk"])
        return [*super()._get_data_files(), ("fingerpad", "config/specimens", str(target), names), rules]


setup(cmdclass={"build_py": BuildWithSpecimens})
