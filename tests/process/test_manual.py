"""What --help tells, the manual pages and the completion tell too, and nothing that is not there."""

import re
import subprocess
import sys

from rig import BIN, ROOT, HELLO, ProcessTest, clean_environment

MAN = ROOT / "docs/man"
sys.path.insert(0, str(MAN))
import make_configuration_page  # noqa: E402  its folder is known only now

NESTED = {"flight": ("show",), "cam": ("disassemble",), "lab": ("table-4.1",)}  # a subcommand of each that has some
EVERYWHERE = {"--help", "--socket"}  # options of the program that may follow a subcommand


def options_of(text):
    return set(re.findall(r"(?<![\w-])--[a-z][a-z-]*", text))


def options_of_help(text):
    """Those that are defined, not those that a description mentions."""
    return options_of("\n".join(re.findall(r"^  (?:-\w,)?--\S+", text, re.MULTILINE)))


def troff(name):
    return (MAN / name).read_text().replace("\\-", "-")


def sections(text):
    """Title to body of each .SS; the rest is under ""."""
    first, *others = re.split(r"^\.SS ", re.sub(r"^\.SH (?!SUBCOMMANDS)", ".SS  ", text, flags=re.M),
                              flags=re.MULTILINE)
    return {"": first} | {other.split()[0]: other for other in others}


def told(section):
    """Options that it describes."""
    return set(re.findall(r"^\.BI? .*?(--[a-z-]+)", section, re.MULTILINE))


class Manual(ProcessTest):
    def help(self, program, *words):
        result = self.run_program(program, *words, "--help")
        self.assertEqual(result.returncode, 0)
        return result.stdout

    def command_help(self, command):
        return self.help("thimble", command, *NESTED.get(command, ()))

    def commands(self):
        listed = self.help("thimble").split("Subcommands:\n")[1].split("\n\n")[0]
        return re.findall(r"^  ([a-z-]+)", listed, re.MULTILINE)

    def completed(self, program, *words, environment=None):
        script = (f". {MAN}/{program}.bash; COMP_WORDS=({program} {' '.join(words)} ''); "
                  f"COMP_CWORD={len(words) + 1}; _{program.replace('-', '_')}; printf '%s\\n' \"${{COMPREPLY[@]}}\"")
        if words and words[-1] == "--":
            script = script.replace(" '')", ")").replace(f"COMP_CWORD={len(words) + 1}",
                                                         f"COMP_CWORD={len(words)}")
        return set(subprocess.run(["bash", "-c", script], capture_output=True, text=True, check=True,
                                  env=environment or clean_environment()).stdout.split())

    def test_the_page_of_thimble_tells_every_subcommand_and_option(self):
        page = sections(troff("thimble.1"))
        commands = self.commands()
        self.assertIn("clear-fault", commands)
        for command in commands:
            with self.subTest(command):
                wanted = options_of_help(self.command_help(command)) - EVERYWHERE
                self.assertEqual({name for name in told(page[command]) if name != "--summary"}, wanted)
        self.assertLessEqual(options_of_help(self.help("thimble")), options_of(troff("thimble.1")))
        titles = {title for title in re.findall(r"^\.SS (\S+)", troff("thimble.1"), re.MULTILINE)}
        self.assertEqual(titles, set(commands))

    def test_the_page_tells_every_experiment_of_the_lab_with_its_options(self):
        listed = self.help("thimble", "lab").split("Subcommands:\n")[1]
        experiments = re.findall(r"^  ([a-z0-9.-]+)", listed, re.MULTILINE)
        page = {title: text for title, text in
                re.findall(r"^\.SS lab (\S+).*?\n(.*?)(?=^\.SS )", troff("thimble.1"), re.MULTILINE | re.DOTALL)}
        self.assertEqual(set(page), set(experiments))
        self.assertEqual(self.completed("thimble", "lab"), set(experiments))
        for experiment in experiments:
            with self.subTest(experiment):
                wanted = options_of_help(self.help("thimble", "lab", experiment)) - EVERYWHERE
                self.assertEqual(told(page[experiment]), wanted)
                self.assertEqual(self.completed("thimble", "lab", experiment, "--"), wanted | EVERYWHERE)

    def test_the_page_of_thimbled_tells_every_option(self):
        defined = re.findall(r"^\.TP\n\.\w+ .*", troff("thimbled.8"), re.MULTILINE)
        self.assertEqual(options_of("\n".join(defined)), options_of_help(self.help("thimbled")))

    def test_the_page_of_thimble_simdev_tells_every_option_and_verb(self):
        page = troff("thimble-simdev.1")
        options, verbs = page.split(".SH VERBS")
        defined = re.findall(r"^\.TP\n\.\w+ .*", options, re.MULTILINE)
        self.assertEqual(options_of("\n".join(defined)), options_of_help(self.help("thimble-simdev")))
        self.assertEqual(self.completed("thimble-simdev", "--"), options_of_help(self.help("thimble-simdev")))
        source = (ROOT / "sim/export/verb.cpp").read_text()
        words = re.findall(r'^    \{"([a-z-]+)", VerbKind::', source, re.MULTILINE)
        self.assertEqual(re.findall(r"^\.T[PQ]\n\.BI? ([a-z-]+)", verbs.split(".SH EXIT")[0], re.MULTILINE), words)

    def test_completion_offers_every_subcommand_and_option(self):
        commands = self.commands()
        self.assertEqual(self.completed("thimble"),
                         set(commands) | options_of_help(self.help("thimble")))
        for command in commands:
            with self.subTest(command):
                self.assertEqual(self.completed("thimble", command, *NESTED.get(command, ()), "--"),
                                 options_of_help(self.command_help(command)) | EVERYWHERE)
        for nested in (("cam", "run"), ("cam", "list")):
            with self.subTest(nested):
                self.assertEqual(self.completed("thimble", *nested, "--"),
                                 options_of_help(self.help("thimble", *nested)) | EVERYWHERE)
        self.assertEqual(self.completed("thimbled", "--"), options_of_help(self.help("thimbled")))

    def test_completion_offers_the_arms_of_the_daemon(self):
        daemon = self.start(config=HELLO)
        environment = clean_environment()
        environment["PATH"] = f"{BIN}:{environment['PATH']}"
        self.assertEqual(self.completed("thimble", "--socket", daemon.socket, "activate",
                                        environment=environment), {"right"})

    def test_the_page_of_the_configuration_has_every_key(self):
        markdown = (ROOT / "docs/configuration.md").read_text()
        page = make_configuration_page.page(markdown)
        keys = re.findall(r"^\| `([a-z_.]+)` \|", markdown, re.MULTILINE)
        self.assertGreater(len(keys), 40)
        for key in keys:
            self.assertIn(f"\n.B {key}\n", page)
        self.assertNotIn("`", page)
        self.assertNotIn("](", page)
        self.assertNotIn("\n|", page)

    def test_no_text_of_the_configuration_is_taken_for_a_request(self):
        page = make_configuration_page.page("# x\n\n.hidden and 'quoted\n'so\n\n    --set a\\b\n")
        self.assertIn("\n\\&.hidden and 'quoted\n\\&'so\n", page)
        self.assertIn("\n\\-\\-set a\\eb\n", page)
