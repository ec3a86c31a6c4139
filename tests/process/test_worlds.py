"""Worlds of the real program: the sphere of examples/sphere.toml, and what does not go with it."""

from rig import EXAMPLES, ProcessTest

SPHERE = ("--config", EXAMPLES / "sphere.toml")


class Sphere(ProcessTest):
    def test_the_example_is_felt_and_has_no_cells(self):
        daemon = self.start(*SPHERE, "--set", "arm.hand.speed_m_per_s=0.1")
        status = daemon.status_when(
            lambda s: s["arms"][0]["contacts"] > 0 and s["arms"][0]["peak_force_newton"] > 0.3)
        self.assertEqual(status["arms"][0]["faults"], [])
        world = status["worlds"][0]
        self.assertEqual((world["source"], world["cells"], world["cell_m"], world["probes"]),
                         ("sphere", [0, 0, 0], 0, 1))
        shown = self.thimble(daemon, "status")
        self.assertEqual(shown.returncode, 0, shown.stderr)
        self.assertIn("sphere", shown.stdout)
        self.assertNotIn("0 x 0", shown.stdout)
        self.assertEqual(daemon.stop(), 0)

    def test_what_does_not_go_with_it_is_refused_at_its_key(self):
        for setting, key, reason in (
                ("world.constraint_model=simple", "world.0.constraint_model", "works on cells"),
                ("world.listen=udp://127.0.0.1:0", "world.0.listen", "across the axes only"),
                ("arm.coupling.scheme=thesis-literal", "arm.0.coupling", "across the axes only")):
            result = self.thimbled(*SPHERE, "--set", setting, "--check")
            self.assertEqual(result.returncode, 2, result.stderr)
            self.assert_one_sentence(result.stderr, key, reason)
