"""What tests of scripts/analysis share: where the package is. Each runs as `NAME_test.py SOURCE_FOLDER`."""
import sys
from pathlib import Path

SOURCE = Path(sys.argv.pop(1)).resolve()
sys.path.insert(0, str(SOURCE / "scripts"))
sys.dont_write_bytecode = True  # the source tree stays as it is
