"""What tests of the scripts that write scenes share. Called by generate_test.py and generate_mesh_test.py."""
import pathlib
import subprocess

from command import CommandTest

SCENES = pathlib.Path(__file__).resolve().parents[2] / "scenes"


class GeneratorTest(CommandTest):
    script = ""  # its name in scenes/

    def generate(self, *arguments):
        return subprocess.run([SCENES / self.script, *map(str, arguments)], cwd=self.folder, capture_output=True, text=True,
                              check=False)

    def generate_well(self, *arguments):
        result = self.generate(*arguments)
        self.assertEqual((result.returncode, result.stderr), (0, ""), arguments)

    def assert_each_refused(self, *calls):
        for arguments in calls:
            before = self.listing()
            result = self.generate(*arguments)
            self.assertNotEqual(result.returncode, 0, arguments)
            self.assertNotIn("Traceback", result.stderr, arguments)
            self.assertEqual(self.listing(), before)
