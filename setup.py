"""The built-in specimens: config/specimens, which people edit and a clone reads, and of which a built package carries a copy."""

from pathlib import Path

from setuptools import setup
from setuptools.command.build_py import build_py


class BuildWithSpecimens(build_py):
    """Also takes config/specimens, as fingerpad/built_in/specimens (`fingerpad.files.BUILT_IN`)."""

    def _get_data_files(self):
        names = sorted(path.name for path in Path("config/specimens").glob("*.yaml"))
        target = Path(self.build_lib, "fingerpad", "built_in", "specimens")
        return [*super()._get_data_files(), ("fingerpad", "config/specimens", str(target), names)]


setup(cmdclass={"build_py": BuildWithSpecimens})
