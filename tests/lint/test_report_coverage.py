import pathlib
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
import report_coverage as sut  # noqa: E402


def file(name, lines, lines_reached, branches, branches_reached):
    return {"filename": name, "line_total": lines, "line_covered": lines_reached,
            "branch_total": branches, "branch_covered": branches_reached}


class ReportCoverage(unittest.TestCase):
    def report(self, *files):
        return sut.report(sut.rows({"files": list(files)}))

    def test_sums_a_folder_and_names_the_worst_file_first(self):
        lines = self.report(file("daemon/link/a.cpp", 10, 10, 10, 9), file("daemon/link/b.cpp", 10, 5, 10, 5),
                            file("daemon/link/whole.cpp", 20, 20, 20, 20))

        self.assertEqual(len(lines), 3)
        self.assertIn("daemon/link ", lines[0])
        self.assertIn("87.5 % of    40 lines", lines[0])
        self.assertIn("85.0 % of    40 branches", lines[0])
        self.assertIn("b.cpp", lines[1])
        self.assertIn("a.cpp", lines[2])

    def test_says_whether_the_goal_is_met_where_there_is_one(self):
        self.assertIn("goal 95 %: met", self.report(file("daemon/servo/a.cpp", 1, 1, 100, 95))[0])
        self.assertIn("goal 95 %: MISSED", self.report(file("daemon/servo/a.cpp", 1, 1, 100, 94))[0])
        self.assertNotIn("goal", self.report(file("daemon/world/a.cpp", 1, 1, 100, 10))[0])

    def test_a_file_without_branches_misses_none(self):
        self.assertEqual(len(self.report(file("daemon/servo/a.hpp", 3, 3, 0, 0))), 1)
