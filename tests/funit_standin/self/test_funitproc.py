"""Tests of the preprocessor: what it makes of a source, and what it refuses."""

import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))

from funitproc import SourceError, convert  # noqa: E402

SOURCE = """\
module test_sum
   use funit
   implicit none
contains
   @test
   ! of two numbers
   subroutine adds()
      @assertEqual(3, 1 + 2, message="a sum (of two)")
   end subroutine adds
end module test_sum
"""
PATH = Path("folder/test_sum.pf")


class Conversion(unittest.TestCase):
    """A source that is right."""

    def test_assertion_becomes_a_call_with_its_place(self):
        self.assertIn(
            'call assertEqual(3, 1 + 2, message="a sum (of two)", &\n'
            '         location=sourcelocation("test_sum.pf", 8))\n'
            "      if (anyexceptions()) return\n",
            convert(SOURCE, PATH),
        )

    def test_every_test_is_run(self):
        self.assertIn(
            'subroutine test_sum_suite()\n   use funit, only: run_test\n   use test_sum\n'
            '   implicit none\n\n   call run_test("test_sum_suite.adds", &\n      adds)\n',
            convert(SOURCE, PATH),
        )

    def test_no_annotation_is_left(self):
        self.assertNotIn("@", convert(SOURCE, PATH))


class Refusal(unittest.TestCase):
    """A source that is wrong: a test that was passed over would be a test that cannot fail."""

    def assert_refused(self, line, old, new):
        with self.assertRaisesRegex(SourceError, f"^folder/test_sum.pf:{line}: error: "):
            convert(SOURCE.replace(old, new), PATH)

    def test_module_of_another_name(self):
        self.assert_refused(1, "module test_sum", "module test_product")

    def test_unknown_annotation(self):
        self.assert_refused(5, "@test", "@tset")

    def test_unknown_assertion(self):
        self.assert_refused(8, "@assertEqual", "@assertAlmostEqual")

    def test_assertion_on_two_lines(self):
        self.assert_refused(8, "1 + 2,", "1 + 2, &\n")

    def test_assertion_with_a_comment(self):
        self.assert_refused(8, '(of two)")', '(of two)") ! three')

    def test_test_without_subroutine(self):
        self.assert_refused(7, "subroutine adds()\n", "integer function adds()\n")

    def test_test_with_arguments(self):
        self.assert_refused(7, "adds()", "adds(this)")

    def test_no_tests(self):
        self.assert_refused(1, "   @test\n", "   !\n")


if __name__ == "__main__":
    unittest.main()
