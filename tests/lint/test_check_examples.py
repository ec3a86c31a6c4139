import check_examples
from planted_tree import PlantedTreeTest


class CheckExamples(PlantedTreeTest):
    def setUp(self):
        super().setUp()
        self.plant("examples/README.md", "| file | what |\n|---|---|\n| `box.toml` | the box: `box.npy` |\n")
        self.plant("examples/box.toml", 'source = "box.npy"\n')
        self.plant("examples/box.npy", "")
        self.plant("README.md", "thimbled --config examples/box.toml\n")

    def test_accepts_what_is_listed_used_and_there(self):
        self.assertEqual(check_examples.check(self.root), [])

    def test_a_tree_without_examples_has_no_dead_ones(self):
        for name in ("README.md", "box.toml", "box.npy"):
            (self.root / "examples" / name).unlink()
        self.assertEqual(check_examples.check(self.root), [])

    def test_refuses_a_configuration_that_nothing_uses(self):
        self.plant("README.md", "thimbled --config my-box.toml.old\n")
        self.assert_one_breach(check_examples.check(self.root), "examples/box.toml", "dead")

    def test_a_test_or_the_demo_is_a_use(self):
        for user in ("run", "tests/process/test_box.py"):
            with self.subTest(user):
                self.plant("README.md", "")
                self.plant(user, 'start("box.toml")\n')
                self.assertEqual(check_examples.check(self.root), [])
                (self.root / user).unlink()

    def test_refuses_data_that_no_configuration_needs(self):
        self.plant("examples/box.toml", 'source = "hello-voxel"\n')
        self.plant("examples/README.md", "| `box.toml` | the box |\n")
        breaches = check_examples.check(self.root)
        self.assertEqual(len(breaches), 2, breaches)
        self.assertIn("does not list it", breaches[0])
        self.assertIn("examples/box.npy: dead", breaches[1])

    def test_refuses_a_list_of_what_is_gone(self):
        (self.root / "examples/box.npy").unlink()
        self.assert_one_breach(check_examples.check(self.root), "examples/README.md", "box.npy")

    def test_refuses_a_page_that_names_what_is_not_there(self):
        self.plant("docs/guide.md", "first\nthen `examples/cave.toml`.\n")
        self.assert_one_breach(check_examples.check(self.root), "docs/guide.md:2", "examples/cave.toml")
