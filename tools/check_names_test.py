#!/usr/bin/env python3
"""Tests of check_names.py on small sources."""

import unittest
from pathlib import Path

import check_names


def names(text, path="a.h"):
    """The definitions that other sources see."""
    return [d.name for d in check_names.definitions_of(text, Path(path)) if not d.is_internal]


def found(**sources):
    """The places of the findings in sources by name: a_h is src/a.h, tests__b_cc is tests/b.cc."""
    definitions = []
    for name, text in sources.items():
        path = name.replace("__", "/")
        path = "src/" + path if path == name else path
        stem, _, ending = path.rpartition("_")
        definitions += check_names.definitions_of(text, Path(f"{stem}.{ending}"))
    return [f"{finding.path}:{finding.line}" for finding in sorted(check_names.findings_of(definitions))]


class DefinitionsTest(unittest.TestCase):
    def test_types_of_namespaces(self):
        self.assertEqual(names("namespace n {\nstruct A final : B<int> {\n  struct Inner {};\n};\nenum class E : int { kA };\n}"),
                         ["n::A", "n::E"])
        self.assertEqual(names("namespace n::m { class A; template <typename T> class B { }; }"), ["n::m::B"])
        self.assertEqual(names("using A = std::vector<int>;"), ["A"])
        self.assertEqual(names("template <>\nstruct std::hash<A> {\n};"), ["std::hash<A>"])

    def test_functions_by_the_types_of_their_parameters(self):
        self.assertEqual(names("int F(const A& a, std::size_t, int b = G(1, 2)) { return 0; }"),
                         ["F(const A&, std::size_t, int)"])
        self.assertEqual(names("std::map<int, int> A::F(void) const { }"), ["A::F() const"])
        self.assertEqual(names("A::A(int a) : b_{a}, c_(a) { }\nbool operator==(A a, B b) { }"), ["A::A(int)", "operator==(A, B)"])
        self.assertEqual(names("template <typename T>\n  requires std::integral<T>\nT F(T value) { }"), ["F(T)"])
        self.assertEqual(names("int F(int a);\nint F(double a) noexcept;"), [])

    def test_variables(self):
        self.assertEqual(names("inline constexpr int kA = 1;\nint b = 2;\nconst char* c = \"\";"), ["kA", "b", "c"])
        self.assertEqual(names("constexpr int kA = 1;\nconst char* const kB = \"\";\nstatic int c;\nextern int d;"), [])

    def test_what_only_its_source_sees(self):
        self.assertEqual(names("namespace {\nstruct A { };\nint F() { }\n}\nstatic int G() { }"), [])
        self.assertEqual(names("using A = int;", "a.cc"), [])

    def test_comments_and_texts_define_nothing(self):
        self.assertEqual(names('// struct A {};\n/* int F() { } */\nconst int kA = 1\'000;\nTEST(A, B) { F("}"); }\n'), [])
        self.assertEqual(names('const char* const kText = R"x(struct A { }; ")" )x";\n#define B struct C { };\n'), [])


class FindingsTest(unittest.TestCase):
    def test_one_name_in_two_headers(self):
        self.assertEqual(found(a_h="namespace n { struct A { }; }", b_h="namespace n {\nstruct A { };\n}"), ["src/b.h:2"])
        self.assertEqual(found(a_h="inline int F(int a) { }", b_h="inline int F(int b) { }"), ["src/b.h:1"])
        self.assertEqual(found(a_h="inline constexpr int kA = 1;", b_h="inline constexpr int kA = 2;"), ["src/b.h:1"])

    def test_two_sources_outside_unnamed_namespaces(self):
        self.assertEqual(found(a_cc="struct A { };", b_cc="struct A { };"), ["src/b.cc:1"])

    def test_other_namespaces_and_overloads_are_accepted(self):
        self.assertEqual(found(a_h="namespace n { struct A { }; }", b_h="namespace m { struct A { }; }"), [])
        self.assertEqual(found(a_h="inline int F(int a) { }", b_h="inline int F(double a) { }"), [])

    def test_a_hidden_type_with_the_name_of_a_seen_one(self):
        self.assertEqual(found(a_h="struct A { };", tests__b_cc="namespace { struct A { }; }"), ["tests/b.cc:1"])

    def test_hidden_types_collide_within_a_folder(self):
        hidden = "namespace { struct A { }; }"
        self.assertEqual(found(a_cc=hidden, b_cc=hidden), ["src/b.cc:1"])
        self.assertEqual(found(a_cc=hidden, tests__b_cc=hidden), [])

    def test_hidden_functions_collide_only_in_a_library(self):
        hidden = "namespace { int F() { } }"
        self.assertEqual(found(a_cc=hidden, b_cc=hidden), ["src/b.cc:1"])
        self.assertEqual(found(a_cc=hidden, b_test_cc=hidden), [])

    def test_alternatives_are_accepted(self):
        self.assertEqual(found(a_cc="#if A\nstruct A { };\n#else\nstruct A { };\n#endif"), [])
        self.assertEqual(found(a_h="using A = std::array<int, 2>;", b_h="using A = std::array<int,2>;"), [])
        self.assertEqual(found(a_cc="int main() { }", b_cc="int main() { }"), [])


if __name__ == "__main__":
    unittest.main()
