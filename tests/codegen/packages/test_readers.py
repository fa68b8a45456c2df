"""The libraries that read ESP-IDF components and Zephyr options accept the packages."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tests.codegen.packages.made import in_folder, reader, run

pytestmark = pytest.mark.slow

COMPONENT = """
import json, sys
from idf_component_tools.manager import ManifestManager
manifest = ManifestManager(sys.argv[1], "pioneer3dx").load()
print(json.dumps([str(manifest.version), manifest.description, manifest.license]))
"""
OPTIONS = """
import json, sys
from kconfiglib import Kconfig
options = Kconfig(sys.argv[1])
values = [options.warnings]
for name in ("WMRGEN_PIONEER3DX", "WMRGEN_PIONEER3DX_SELFTEST"):
    options.syms[name].set_value("y")
    values.append([options.syms[k].str_value for k in ("WMRGEN_PIONEER3DX", "WMRGEN_PIONEER3DX_SELFTEST", "FPU")])
print(json.dumps(values))
"""


def test_the_component_manager_reads_the_manifest(tmp_path: Path) -> None:
    place = in_folder(tmp_path, "pioneer3dx", "esp-idf")
    version, description, licence = json.loads(run(tmp_path, reader(), "-c", COMPONENT, place))
    assert version.count(".") == 2 and licence == "MIT-0"
    assert description == "Pioneer P3-DX, differential drive with calibration"


def test_kconfig_reads_the_options(tmp_path: Path) -> None:
    """The options are included as in Zephyr's tree. By default the self-test is off, and the FPU on if there is one."""
    place = in_folder(tmp_path, "pioneer3dx", "zephyr")
    top = f'config FPU\n\tbool "FPU"\nsource "{place}/zephyr/Kconfig"\n'
    (tmp_path / "Kconfig").write_text(top)
    warnings, *values = json.loads(run(tmp_path, reader(), "-c", OPTIONS, tmp_path / "Kconfig"))
    assert warnings == [] and values == [["y", "n", "y"], ["y", "y", "y"]]
