"""File names, scenes and variables that are no UTF-8, or that a terminal would obey, lose no file and reach no terminal."""

import json
import os
import shlex
import struct
import zlib

from command import SCENE, CommandTest, changed, main

NOT_UTF8 = b"bad\xff.json"
ESCAPE = "red\x1b[31m\x07\n.json"


def png_texts(data):
    """The texts of a PNG file by their names."""
    texts, at = {}, 8
    while at < len(data):
        size, kind = struct.unpack(">I4s", data[at:at + 8])
        body = data[at + 8:at + 8 + size]
        if kind == b"tEXt":
            name, text = body.split(b"\0", 1)
            texts[name.decode()] = text.decode("latin-1")
        elif kind == b"iTXt":
            name, rest = body.split(b"\0", 1)
            text = rest[2:].split(b"\0", 2)[2]
            texts[name.decode()] = (zlib.decompress(text) if rest[0] else text).decode()
        at += 12 + size
    return texts


class Text(CommandTest):
    def setUp(self):
        super().setUp()
        for name in (NOT_UTF8, ESCAPE.encode()):
            (self.folder / os.fsdecode(name)).write_text(json.dumps(SCENE))

    def run_bytes(self, *arguments, status=0, **keywords):
        """The finished process, with what it printed as bytes: valid UTF-8 on lines, and nothing for a terminal."""
        result = self.run_command(*[os.fsdecode(a) if isinstance(a, bytes) else a for a in arguments], text=None,
                                  errors=None, **keywords)
        self.assertEqual(result.returncode, status, result.stderr)
        for said in (result.stdout, result.stderr):
            self.assertNotRegex(said.decode(), r"[\x00-\x09\x0b-\x1f\x7f-\x9f]")
        return result

    def json_of(self, name):
        return json.loads((self.folder / name).read_bytes().decode())

    def test_of_a_scenes_name_reaches_every_file_of_a_render(self):
        for scene, name in ((NOT_UTF8, "bad\ufffd"), (ESCAPE.encode(), "red\x1b[31m\x07\n")):
            for image in ("out.exr", "out.png"):
                self.run_bytes("render", scene, "--spp", 1, "-o", image, "--stats", "s.json", "--trace", "t.json",
                               "--cost-image", "cost.exr")
                self.assertEqual(self.json_of("s.json")["settings"]["scene"], name)
                self.assertEqual(self.json_of("t.json")["otherData"]["raypool.scene"], name)
                self.assertIn(b"raypool.scene", (self.folder / image).read_bytes())
            self.assertEqual(png_texts((self.folder / "out.png").read_bytes())["raypool.scene"], name)
            self.assertIn(name.encode(), (self.folder / "out.exr").read_bytes())

    def test_of_a_scenes_name_reaches_the_files_of_compare_and_advise(self):
        self.run_bytes("compare", NOT_UTF8, "--spp", 1, "--check", "--json", "c.json")
        self.assertEqual(self.json_of("c.json")["scene"], "bad\ufffd")
        said = self.run_bytes("advise", NOT_UTF8, "--target-error", 0.5, "--threads", 1, "--json", "a.json").stdout
        self.assertIn("bad\ufffd", self.json_of("a.json")["scene"])
        command = self.json_of("a.json")["offers"][0]["command"]
        self.assertIn(command, said.decode())
        self.assertIn(r"$'bad\xff.json'", command)

    def test_of_every_file_name_is_shown_without_what_a_terminal_obeys(self):
        for kind in ("-o", "--cost-image"):
            for name in (b"i\xff.pfm", b"i\x1b[2J\n.pfm"):
                self.assertIn(b"i\\x", self.run_bytes("render", "scene.json", "--spp", 1, kind, name).stdout)
        self.assertIn(b"t\\xff", self.run_bytes("render", "scene.json", "--spp", 1, "--trace", b"t\xff").stdout)
        self.run_bytes("diff", b"i\xff.pfm", b"i\xff.pfm", "-o", b"d\xff.pfm")
        self.run_bytes("info", ESCAPE)
        for command in (("render", b"no\xff\x1b.json"), ("info", b"no\xff\x1b.json"), ("diff", b"\xff.pfm", b"\x1b.pfm"),
                        ("merge", b"no\xff\x1b"), ("render", "scene.json", b"--\xff\x1b[2J"), (b"\xff\x1b",),
                        ("render", "scene.json", "--schedule", b"\xff\x1b"), ("render", "scene.json", "-o", b"\xff/a.png")):
            said = self.run_bytes(*command, status=2).stderr
            self.assertEqual(said.count(b"\n"), 1, said)
            self.assertIn(b"\\x", said)

    def test_of_a_description_is_shown_without_what_a_terminal_obeys(self):
        self.write("told.json", changed(SCENE, "/description", "a\x1b[2Jb\x9bc\u202ed"))
        said = self.run_bytes("info", "told.json").stdout.decode()
        self.assertIn(r"a\x1b[2Jb\u009bc\u202ed", said)

    def test_of_the_environment_is_recorded(self):
        environment = {b"OMP_\xff": b"a\xfe", b"OMP_AFFINITY_FORMAT": b"\xf0\x28 \xc3\xa9"}
        clean = {os.fsencode(k): os.fsencode(v) for k, v in os.environ.items() if not k.startswith(("OMP_", "KMP_", "GOMP_"))}
        import subprocess
        subprocess.run([self.command, "render", "scene.json", "--spp", "1", "--stats", "s.json"], cwd=self.folder,
                       env={**clean, **environment}, check=True, stdout=subprocess.DEVNULL)
        self.assertEqual(self.json_of("s.json")["environment"]["openmp"],
                         {"OMP_\ufffd": "a\ufffd", "OMP_AFFINITY_FORMAT": "\ufffd( é"})

    def test_of_advice_is_a_command_that_runs(self):
        self.run_bytes("advise", NOT_UTF8, "--target-error", 0.5, "--threads", 1, "--json", "a.json")
        command = self.json_of("a.json")["offers"][0]["command"].replace("raypool", shlex.quote(self.command), 1)
        import subprocess
        subprocess.run(["bash", "-c", command + " --quiet"], cwd=self.folder, check=True, timeout=60)


if __name__ == "__main__":
    main()
