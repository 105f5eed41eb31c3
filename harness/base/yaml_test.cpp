#include "harness/base/yaml.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

namespace raystudy {
namespace {

using testing::ElementsAre;

struct Parsed {
  std::shared_ptr<const YamlNode> root;
  std::vector<std::string> problems;
};

Parsed parse(const std::string& text) {
  std::vector<Diagnostic> problems;
  Parsed parsed;
  parsed.root = parse_yaml(text, "x.yaml", problems);
  for (const Diagnostic& problem : problems) parsed.problems.push_back(problem.text());
  return parsed;
}

std::string refusal(const std::string& text) {
  try {
    (void)parse(text);
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

TEST(Yaml, KeepsTheOrderAndThePlacesOfKeysAndValues) {
  const Parsed parsed = parse("b: [1, 'two']\na:\n  c: ~\n");
  const YamlNode& root = *parsed.root;
  ASSERT_EQ(root.entries.size(), 2U);
  EXPECT_EQ(root.entries[0].key, "b");
  EXPECT_EQ(root.entries[0].where.text(), "x.yaml:1:1");
  EXPECT_EQ(root.entries[1].where.text(), "x.yaml:2:1");
  const YamlNode& list = *root.find("b");
  ASSERT_EQ(list.items.size(), 2U);
  EXPECT_EQ(list.where.text(), "x.yaml:1:4");
  EXPECT_EQ(list.items[1]->where.text(), "x.yaml:1:8");
  EXPECT_TRUE(list.items[0]->plain);
  EXPECT_FALSE(list.items[1]->plain);
  EXPECT_TRUE(root.find("a")->find("c")->is_null());
  EXPECT_EQ(root.find("d"), nullptr);
  EXPECT_TRUE(parsed.problems.empty());
  EXPECT_TRUE(parse("").root->is_null());
  EXPECT_TRUE(parse("# nothing\n").root->is_null());
}

TEST(Yaml, DescribesValuesAsAUserWould) {
  const Parsed parsed = parse("[abc, 'a', \"3\", 3, -4, 2.5, 1e3, true, 'true', ~, [], {}, .inf, 1a]");
  std::vector<std::string> texts;
  for (const auto& item : parsed.root->items) texts.push_back(described(*item));
  EXPECT_THAT(texts, ElementsAre("the text 'abc'", "the text 'a'", "the text '3'", "the integer 3", "the integer -4",
                                 "the number 2.5", "the number 1e3", "the truth value true", "the text 'true'", "nothing",
                                 "a list", "a map", "the text '.inf'", "the text '1a'"));
}

TEST(Yaml, ReportsDuplicatesAndGoesOn) {
  const Parsed parsed = parse("a: 1\nb: {c: 1, c: 2}\na: 3\n");
  EXPECT_THAT(parsed.problems,
              ElementsAre("x.yaml:2:11: key 'c' stands a second time; expected each key once; the first is on line 2",
                          "x.yaml:3:1: key 'a' stands a second time; expected each key once; the first is on line 1"));
  EXPECT_EQ(parsed.root->find("a")->text, "1");
}

TEST(Yaml, ReportsKeysThatAreNoText) {
  EXPECT_THAT(parse("? [a, b]\n: 1\n").problems, ElementsAre("x.yaml:1:3: a key is a list; expected a text"));
  EXPECT_THAT(parse("{a: 1, : 2}\n").problems, ElementsAre("x.yaml:1:8: a key is nothing; expected a text"));
}

TEST(Yaml, AliasesShareTheNodeOfTheirAnchor) {
  const Parsed parsed = parse("a: &x {b: 1}\nc: *x\n");
  EXPECT_EQ(parsed.root->find("a"), parsed.root->find("c"));
  EXPECT_THAT(parse("a: &x [*x]\n").problems,
              ElementsAre("x.yaml:1:8: an alias stands inside its own anchor; expected an anchor that ends before its alias"));
}

TEST(Yaml, AnAliasThatMultipliesItselfTakesNoMemory) {
  std::string text = "a0: &a0 [x, x]\n";
  for (int i = 1; i < 60; ++i) {
    text += fmt::format("a{0}: &a{0} [*a{1}, *a{1}]\n", i, i - 1);
  }
  EXPECT_EQ(parse(text).root->entries.size(), 60U);
}

TEST(Yaml, RefusesWhatIsNoYaml) {
  EXPECT_EQ(refusal("a: [1, 2\n"), "x.yaml:2:1: this is no YAML: end of sequence flow not found");
  EXPECT_EQ(refusal("a: b: c\n"), "x.yaml:1:5: this is no YAML: illegal map value");
  EXPECT_EQ(refusal("a: *b\n"), "x.yaml:1:4: this is no YAML: the referenced anchor is not defined");
  EXPECT_EQ(refusal("a: 'b"), "x.yaml:1:6: this is no YAML: illegal EOF in scalar");
  EXPECT_THAT(refusal(std::string(100000, '[')), testing::StartsWith("x.yaml:1:"));
}

TEST(Yaml, ReportsAQuoteThatIsNotClosed) {
  EXPECT_THAT(parse("b: ''\na: 'b''\nc: 1\n").problems,
              ElementsAre("x.yaml:2:4: the quote ' is not closed; expected ' at the text's end"));
  EXPECT_THAT(parse("a: &x \"b\\\"\n").problems,
              ElementsAre("x.yaml:1:4: the quote \" is not closed; expected \" at the text's end"));
  EXPECT_THAT(parse("a: 'it''s'\nb: \"\\\\\"\nc: |\n  it's\nd: !t 'x'\n").problems, ElementsAre());
}

TEST(Yaml, RefusesASecondDocument) {
  EXPECT_THAT(parse("a: 1\n---\nb: 2\n").problems,
              ElementsAre("x.yaml:3:1: a second document begins; expected one document a file"));
}

TEST(Yaml, NamesTheReasonWhyAFileCannotBeRead) {
  std::vector<Diagnostic> problems;
  const std::string folder = std::filesystem::temp_directory_path().string();
  for (const auto& [file, reason] : {std::pair{folder + "/no-such.yaml", std::string("No such file or directory")},
                                     {folder + "/no/such.yaml", "there is no folder '" + folder + "/no'"},
                                     {folder, "Is a directory"}}) {
    try {
      (void)read_yaml(file, problems);
      FAIL();
    } catch (const Error& error) {
      EXPECT_EQ(error.what(), std::string(file).append(": cannot be read: ").append(reason));
    }
  }
}

}  // namespace
}  // namespace raystudy
