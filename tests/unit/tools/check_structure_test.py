"""What tools/check_structure.py finds, in small trees made for it."""
import os
import subprocess
import sys
import tempfile
import unittest

SCRIPT = os.path.join(os.environ["MORTISE_SOURCE_DIR"], "tools", "check_structure.py")
DRAWING = ("```arrows\nbase →\nmesh → base\nfem → base mesh\n```\n"
           "```messages\nservices/*/service\n```\n")


class CheckStructure(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        subprocess.check_call(["git", "init", "-q", self.folder.name])
        self.write("docs/architecture.md", DRAWING)
        self.write("tools/structure_exceptions.txt", "")
        self.write("tests/tested_elsewhere.txt", "")

    def write(self, name, text):
        path = os.path.join(self.folder.name, name)
        os.makedirs(os.path.dirname(path), exist_ok=True)
        with open(path, "w", encoding="utf-8") as file:
            file.write(text)

    def faults(self):
        result = subprocess.run([sys.executable, SCRIPT], cwd=self.folder.name, text=True,
                                capture_output=True, check=False)
        lines = result.stdout.splitlines()[:-1]
        self.assertEqual(result.returncode, 1 if lines else 0, result.stderr)
        return "\n".join(lines)

    def test_includes_along_the_arrows_are_no_faults(self):
        self.write("common/mesh/mesh.h", '#include "common/base/base.h"\n')
        self.write("common/base/base.h", "")
        self.write("services/one/one.h", '#include "common/mesh/mesh.h"\n')
        self.assertEqual(self.faults(), "")

    def test_an_include_against_the_arrows_is_named(self):
        self.write("common/base/base.h", '#include "common/mesh/mesh.h"\n')
        self.write("common/mesh/mesh.h", "")
        self.assertIn("common/base/base.h: includes common/mesh/mesh.h", self.faults())

    def test_a_folder_that_is_not_drawn_is_named(self):
        self.write("common/other/other.h", '#include "common/base/base.h"\n')
        self.write("common/base/base.h", "")
        self.assertIn("common/other: docs/architecture.md draws no arrows of it", self.faults())

    def test_services_do_not_include_each_other(self):
        self.write("services/one/one.h", '#include "services/two/two.h"\n')
        self.write("services/two/two.h", "")
        self.assertIn("includes services/two/two.h of another program", self.faults())

    def test_folders_that_include_each_other_by_a_way_are_named(self):
        self.write("services/one/a/a.h", '#include "services/one/b/b.h"\n')
        self.write("services/one/b/b.h", '#include "services/one/c/c.h"\n')
        self.write("services/one/c/c.h", '#include "services/one/a/a.h"\n')
        self.assertIn("folders include each other", self.faults())

    def test_only_some_folders_know_messages(self):
        self.write("services/one/service/one.h", "#include <grpcpp/grpcpp.h>\n")
        self.write("services/one/one.h", '#include "mortise/v1/one.pb.h"\n')
        faults = self.faults()
        self.assertIn("services/one/one.h: knows messages", faults)
        self.assertNotIn("services/one/service/one.h: knows", faults)

    def test_folders_other_than_the_store_know_no_sql(self):
        self.write("common/base/store.h", "#include <sqlite3.h>\n")
        self.write("services/one/one.h", "#include <libpq-fe.h>\n")
        faults = self.faults()
        self.assertIn("services/one/one.h: knows SQL", faults)
        self.assertIn("common/base/store.h: knows SQL", faults)

    def test_headers_that_say_so_are_private_to_their_folder(self):
        self.write("services/one/a/part.h", "// A part. Private to\n// this folder.\n#pragma once\n")
        self.write("services/one/a/a.h", '#include "services/one/a/part.h"\n')
        self.write("services/one/b/b.h", '#include "services/one/a/part.h"\n')
        faults = self.faults()
        self.assertIn("services/one/b/b.h: includes", faults)
        self.assertNotIn("services/one/a/a.h: includes", faults)

    def test_loops_over_matrices_that_are_gone_are_named(self):
        self.write("services/one/one.h", "for (const auto& turn : d->Turns(*v).colwise()) {}\n"
                   "for (const auto& turn : turns.colwise()) {}\n")
        self.assertEqual(self.faults().count("loops over a temporary matrix"), 1)

    def test_what_is_too_long_needs_a_reason(self):
        body = "int Long() {\n" + "  ;\n" * 60 + "}\n"
        self.write("services/one/one.h", body)
        self.assertIn("services/one/one.h:Long: has 62 lines", self.faults())
        self.write("tools/structure_exceptions.txt", "services/one/one.h:Long | a table\n")
        self.assertEqual(self.faults(), "")
        self.write("services/one/one.h", "")
        self.assertIn("'services/one/one.h:Long' is no longer needed", self.faults())

    def test_a_source_without_a_test_must_say_what_tests_it(self):
        self.write("services/one/one.cpp", "")
        self.assertIn("services/one/one.cpp: has no test at its mirrored path", self.faults())
        self.write("tests/tested_elsewhere.txt", "services/one/one.cpp | tests/unit/it_test.cpp\n")
        self.assertIn("names tests/unit/it_test.cpp, which there is not", self.faults())
        self.write("tests/unit/it_test.cpp", "")
        self.assertEqual(self.faults(), "")
        self.write("tests/unit/services/one/one_test.cpp", "")
        self.assertIn("'services/one/one.cpp' is no longer needed", self.faults())


if __name__ == "__main__":
    unittest.main()
