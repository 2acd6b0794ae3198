"""Callbacks, Ctrl-C, and Python threads beside a render and within several."""

import os
import signal
import threading
import time
import unittest

import raypool
from place import SCENE
from raypool import _core

LONG = {"width": 64, "height": 48, "spp": 100_000, "engine": "recursive", "threads": 1}  # half a minute at least


class Progress(unittest.TestCase):
    def test_is_told_in_the_calling_thread_until_all_is_done(self):
        seen = []
        me = threading.get_ident()
        _, report = raypool.render(SCENE, spp=50, threads=2,
                                   progress=lambda *paths: seen.append((*paths, threading.get_ident())))
        self.assertEqual(seen[0], (0, report["paths"], me))
        self.assertEqual(seen[-1], (report["paths"], report["paths"], me))
        self.assertGreater(len(seen), 3)
        self.assertEqual(seen, sorted(set(seen)))

    def test_leaves_the_image_as_it_is(self):
        hashes = {raypool.render("cornell", width=30, spp=20, progress=progress, engine=engine)[1]["hash"]
                  for progress in (None, lambda done, total: None) for engine in raypool.engines()}
        self.assertEqual(len(hashes), 1)

    def test_ends_the_render_by_raising(self):
        class Enough(Exception):
            pass

        calls = []

        def progress(done, total):
            calls.append(done)
            if len(calls) == 3:
                raise Enough("for today")

        for options in ({}, {"target_error": 1e-9}):
            calls.clear()
            with self.assertRaisesRegex(Enough, "for today"):
                raypool.render(SCENE, **LONG, **options, progress=progress)
            self.assertEqual(len(calls), 3)
            self.assertEqual(calls, sorted(set(calls)))

    def test_is_told_of_an_adaptive_render(self):
        seen = []
        _, report = raypool.render("half_sky", width=24, target_error=0.02, spp=1000,
                                   progress=lambda *paths: seen.append(paths))
        self.assertEqual(seen[-1][0], report["paths"])
        self.assertEqual({total for _, total in seen}, {24 * report["settings"]["height"] * 1000})

    def test_may_render_itself(self):
        inner = []
        _, report = raypool.render(SCENE, spp=2, threads=1,
                                   progress=lambda *_: inner.append(raypool.render(SCENE, spp=2)[1]["hash"]))
        self.assertEqual(set(inner), {report["hash"]})


class Interrupt(unittest.TestCase):
    def test_comes_out_as_keyboard_interrupt_soon(self):
        self.addCleanup(signal.signal, signal.SIGINT, signal.signal(signal.SIGINT, signal.default_int_handler))
        timer = threading.Timer(1, os.kill, (os.getpid(), signal.SIGINT))
        start = time.monotonic()
        timer.start()
        self.addCleanup(timer.cancel)
        with self.assertRaises(KeyboardInterrupt):
            raypool.render(SCENE, **LONG)
        self.assertLess(time.monotonic() - start, 12)  # and not when all is done
        self.assertTrue(raypool.render(SCENE, spp=1)[1]["hash"])  # and the next one goes well

    def test_runs_other_handlers_and_goes_on(self):
        handled = []
        self.addCleanup(signal.signal, signal.SIGUSR1, signal.signal(signal.SIGUSR1, lambda *_: handled.append(1)))
        report = raypool.render(SCENE, spp=9, progress=lambda done, _: done or os.kill(os.getpid(), signal.SIGUSR1))[1]
        self.assertEqual(handled, [1])
        self.assertEqual(report["samples_done"], 9)


class Threads(unittest.TestCase):
    def test_run_beside_a_render(self):
        """In one piece, so that the GIL is free for as long as the engine works, and not between pieces alone."""
        seconds = []

        def render():
            start = time.monotonic()
            _core.render(raypool.load(SCENE), ["--width=64", "--spp=20000", "--engine=recursive", "--threads=1"], None, False)
            seconds.append(time.monotonic() - start)

        thread = threading.Thread(target=render)
        ticks = 0
        thread.start()
        while thread.is_alive():
            ticks += 1
            time.sleep(0.001)
        self.assertGreater(seconds[0], 0.2, "too short to tell: raise the samples")
        self.assertGreater(ticks, 50)

    def test_render_at_once_each_with_threads_of_its_own(self):
        expected = {engine: raypool.render("cornell", width=30, spp=30, engine=engine)[1]["hash"]
                    for engine in raypool.engines()}
        both = threading.Barrier(2, timeout=60)
        results = []

        def render(engine, threads):
            waited = []

            def progress(done, total):
                if done > 0 and not waited:  # the other one is within its render, too
                    waited.append(both.wait())

            _, report = raypool.render("cornell", width=30, spp=30, engine=engine, threads=threads, progress=progress)
            results.append((engine, threads, report["hash"], len(report["threads"])))

        workers = [threading.Thread(target=render, args=case) for case in (("wavefront", 3), ("recursive", 2))]
        for worker in workers:
            worker.start()
        for worker in workers:
            worker.join(120)
        self.assertEqual(sorted(results), [("recursive", 2, expected["recursive"], 2),
                                           ("wavefront", 3, expected["wavefront"], 3)])

    def test_share_a_scene(self):
        scene = raypool.load("paper")
        hashes = []
        workers = [threading.Thread(target=lambda: hashes.append(raypool.render(scene, width=20, spp=2)[1]["hash"]))
                   for _ in range(4)]
        for worker in workers:
            worker.start()
        for worker in workers:
            worker.join(120)
        self.assertEqual((len(hashes), len(set(hashes))), (4, 1))


if __name__ == "__main__":
    unittest.main()
