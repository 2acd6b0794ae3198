"""`--engine gpu`: refused in one line where it is not built or has no GPU, and the hash of every engine where it has one."""

from command import CommandTest, main


class Gpu(CommandTest):
    def test_says_what_is_missing_or_makes_the_same_image(self):
        for form in ((), ("--gpu-form", "mega"), ("--gpu-form", "mega-regenerate"), ("--gpu-form", "wave", "--pool-rays", "64KB")):
            render = ("render", "cornell", "--width", 24, "--spp", 2, "--engine", "gpu", *form)
            if self.run_command(*render).returncode != 0:
                self.assert_refused(*render, named=["--engine"])
                continue
            hashes = {self.stats("--spp", 3, *engine)["hash"] for engine in (("--engine", "gpu", *form), ())}
            self.assertEqual(len(hashes), 1)

    def test_form_that_is_none_is_refused(self):
        self.assert_refused("render", "cornell", "--engine", "wavefront", "--gpu-form", "warp", named=["--gpu-form", "warp"])


if __name__ == "__main__":
    main()
