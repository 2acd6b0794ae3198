"""The kernels of core/ compile for a GPU, with every operation rounded as on the host: kernels_test.py NVCC SOURCE_FOLDER

What rounding the machine's code promises is in PTX: `.rn` to nearest, and nothing that may be fused with another.
"""
import re
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

SOURCE = Path(sys.argv.pop())
NVCC = sys.argv.pop()


def ptx(fused):
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "kernels.ptx"
        subprocess.run([NVCC, "-std=c++20", "--expt-relaxed-constexpr", "-diag-suppress", "20012,20013,20015",
                        "-Werror", "all-warnings", f"-fmad={fused}", "-ftz=true", "-prec-div=true", "-prec-sqrt=true",
                        "-DEIGEN_DONT_PARALLELIZE", "-DEIGEN_DONT_VECTORIZE", "-I", SOURCE, "-I", "/usr/include/eigen3",
                        "-ptx", SOURCE / "tests/device/kernels.cu", "-o", out], check=True)
        return out.read_text()


def loose_operations(text):
    """Operations on floats that are not rounded to nearest, denormals flushed."""
    operations = re.findall(r"^\s+((?:add|sub|mul|fma|mad|div|rcp|sqrt)\S*\.f(?:32|64))", text, re.MULTILINE)
    return [o for o in operations if not re.fullmatch(r"\w+\.rn\.ftz\.f32", o)]


class Kernels(unittest.TestCase):
    def test_round_every_operation_to_nearest(self):
        text = ptx("false")
        self.assertGreater(len(re.findall(r"fma\.rn\.ftz\.f32", text)), 50)
        self.assertEqual(loose_operations(text), [])

    def test_would_be_found_out_if_the_compiler_fused_operations(self):
        self.assertNotEqual(loose_operations(ptx("true")), [])


if __name__ == "__main__":
    unittest.main()
