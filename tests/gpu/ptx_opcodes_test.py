"""The PTX of the kernels rounds every operation as the host does: ptx_opcodes_test.py KERNELS FUSED FAST

What rounding a chip promises is in PTX: `.rn` to nearest, `.ftz` denormals to zero, and nothing that may be fused with
another or approximated. FUSED and FAST were made by flags that the engine is never compiled with, and must be found out.
"""
import re
import sys
import unittest
from pathlib import Path

FAST, FUSED, KERNELS = (Path(sys.argv.pop()).read_text() for _ in range(3))

ROUNDED = {"add", "sub", "mul", "fma", "mad", "div", "rcp", "sqrt"}
FLUSHED = ROUNDED | {"abs", "neg", "min", "max", "setp", "cvt"}


def opcodes(text):
    return set(re.findall(r"^\s+(?:@!?%p\d+\s+)?([a-z][a-z0-9]*(?:\.[a-z0-9_]+)+)\s", text, re.MULTILINE))


def is_sound(opcode):
    kind, *modifiers = opcode.split(".")
    reals = [m for m in modifiers if m in ("f32", "f64")]
    if not reals or kind not in FLUSHED:
        return "approx" not in modifiers and "full" not in modifiers and kind not in ("ex2", "lg2", "sin", "cos", "tanh")
    if kind in ROUNDED and "rn" not in modifiers:
        return False
    comes_from_integer = kind == "cvt" and modifiers[-1] not in ("f32", "f64")
    return "ftz" in modifiers or "f32" not in reals or comes_from_integer


def loose(text):
    return sorted(opcode for opcode in opcodes(text) if not is_sound(opcode))


class Opcodes(unittest.TestCase):
    def test_are_all_rounded_to_nearest_and_flushed(self):
        found = opcodes(KERNELS)
        for wanted in ("fma.rn.ftz.f32", "div.rn.ftz.f32", "sqrt.rn.ftz.f32", "mul.rn.f64", "setp.lt.ftz.f32"):
            self.assertIn(wanted, found)
        self.assertEqual(loose(KERNELS), [])

    def test_would_be_found_out_if_they_could_be_fused(self):
        self.assertIn("mul.ftz.f32", loose(FUSED))

    def test_would_be_found_out_if_they_were_approximate(self):
        self.assertIn("sqrt.approx.ftz.f32", loose(FAST))

    def test_would_be_found_out_if_denormals_were_kept(self):
        self.assertEqual([o for o in ("add.rn.f32", "neg.f32", "setp.lt.f32", "cvt.rzi.s32.f32") if is_sound(o)], [])
        self.assertTrue(is_sound("cvt.rn.f32.s32") and is_sound("add.rn.f64") and is_sound("selp.f32"))


if __name__ == "__main__":
    unittest.main()
