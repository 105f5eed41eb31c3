// Every mistake in an experiment has its words: where, what was found, what was expected, the nearest name.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "harness/method/registry.h"
#include "harness/spec/plan.h"

namespace raystudy {
namespace {

std::string errors(const std::string& text, Scale scale = Scale::quick) {
  try {
    (void)parse_plan(text, "x.yaml", scale);
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

std::string names(Role role) { return fmt::format("{}", fmt::join(Registry::instance().names(role), ", ")); }

// Lines 1 and 2 of most studies here; what is wrong follows on line 3.
const std::string good = "scenes: [sibenik-ogre]\nmethods: {a: test-builder}\n";
/// `methods` stands on line 2 from column 10 on.
std::string with_methods(const std::string& methods) { return "scenes: [sibenik-ogre]\nmethods: " + methods + "\n"; }
std::string with_builder(const std::string& builder) { return with_methods("{a: {builder: " + builder + "}}"); }

TEST(ReadErrors, Documents) {
  EXPECT_EQ(errors(""), "x.yaml: the file is empty; expected an experiment: a map with 'scenes' and 'methods'");
  EXPECT_EQ(errors("# only a comment\n"), "x.yaml: the file is empty; expected an experiment: a map with 'scenes' and 'methods'");
  EXPECT_EQ(errors("- a\n"), "x.yaml:1:1: the experiment is a list; expected a map");
  EXPECT_EQ(errors("title: x\n"),
            "x.yaml:1:1: the experiment has no 'scenes'; expected a list of scenes\n"
            "x.yaml:1:1: the experiment has no 'methods'; expected a map of name to pipeline");
  EXPECT_EQ(errors("scenes: [a\n"), "x.yaml:2:1: this is no YAML: end of sequence flow not found");
}

TEST(ReadErrors, UnknownAndDuplicateKeys) {
  EXPECT_EQ(errors(good + "repetition: 3\n"),
            "x.yaml:3:1: the experiment has no key 'repetition'; expected one of title, paper, seed, threads, repetitions, "
            "warm_up, timeout, "
            "memory_limit, cost, animation, scenes, tracers, workloads, methods, metrics, tables, figures; did you mean "
            "'repetitions'?");
  EXPECT_EQ(errors(good + "seed: 1\nseed: 2\n"),
            "x.yaml:4:1: key 'seed' stands a second time; expected each key once; the first is on line 3");
  EXPECT_EQ(errors(good + "cost: {ct: 3}\n"), "x.yaml:3:8: 'cost' has no key 'ct'; expected one of c_T, c_I, heuristic");
}

TEST(ReadErrors, Settings) {
  EXPECT_EQ(errors(good + "seed: -1\n"), "x.yaml:3:7: 'seed' is the integer -1; expected an integer >= 0");
  EXPECT_EQ(errors(good + "threads: two\n"), "x.yaml:3:10: 'threads' is the text 'two'; expected an integer in [1, 1024]");
  EXPECT_EQ(errors(good + "repetitions: 2.5\n"),
            "x.yaml:3:14: 'repetitions' is the number 2.5; expected an integer in [1, 100000]");
  EXPECT_EQ(errors(good + "repetitions: [1, 2]\n"), "x.yaml:3:14: 'repetitions' is a list; expected an integer in [1, 100000]");
  EXPECT_EQ(errors(good + "repetitions: \"3\"\n"),
            "x.yaml:3:14: 'repetitions' is the text '3'; expected an integer in [1, 100000]");
  EXPECT_EQ(errors(good + "title: {a: b}\n"), "x.yaml:3:8: 'title' is a map; expected a text");
  EXPECT_EQ(errors(good + "timeout: 10\n"),
            "x.yaml:3:10: 'timeout' is the integer 10; expected a number >= 0 and a unit (ms, s, min, h), such as '10 min'");
  EXPECT_EQ(errors(good + "warm_up: 1 sec\n"),
            "x.yaml:3:10: 'warm_up' is the text '1 sec'; expected a number >= 0 and a unit (ms, s, min, h), such as '0.1 s'");
  EXPECT_EQ(errors(good + "memory_limit: 4 GB\n"),
            "x.yaml:3:15: 'memory_limit' is the text '4 GB'; expected a number >= 0 and a unit (B, KiB, MiB, GiB, TiB), such as "
            "'4 GiB'");
  EXPECT_EQ(errors(good + "cost: 3\n"), "x.yaml:3:7: 'cost' is the integer 3; expected a map");
  EXPECT_EQ(errors(good + "cost: {c_T: -3}\n"), "x.yaml:3:13: 'c_T' is the integer -3; expected a number in [0, 1000000]");
  EXPECT_EQ(errors(good + "cost: {c_T: .nan}\n"), "x.yaml:3:13: 'c_T' is the text '.nan'; expected a number in [0, 1000000]");
  EXPECT_EQ(errors(good + "cost: {heuristic: [surface-area, surface-area]}\n"),
            "x.yaml:3:19: the cost model's heuristic is a sweep; expected one heuristic: all methods are measured by one cost");
}

TEST(ReadErrors, FilesOfMethods) {
  EXPECT_EQ(errors(with_methods("{a: tree-file}")),
            "x.yaml:2:14: builder 'tree-file' has no 'path'; expected the name of a file that can be read");
  EXPECT_EQ(
      errors(with_builder("{tree-file: {path: no.tree}}")),
      "x.yaml:2:43: builder 'tree-file': parameter 'path' is the text 'no.tree'; expected the name of a file that can be read");
}

TEST(ReadErrors, Scales) {
  EXPECT_EQ(errors(good + "seed: {full: 1}\n"),
            "x.yaml:3:7: there is no value for scale 'quick'; expected a value for 'quick'; a larger scale without its own takes "
            "the next "
            "smaller one's");
  EXPECT_EQ(errors(good + "seed: {quick: 1, ful: 2}\n"),
            "x.yaml:3:18: there is no scale 'ful'; expected one of quick, full, paper; did you mean 'full'?");
  EXPECT_EQ(errors(good + "seed: {quick: 1, full: x}\n", Scale::full),
            "x.yaml:3:24: 'seed' is the text 'x'; expected an integer >= 0");
}

TEST(ReadErrors, Scenes) {
  const std::string methods = "methods: {a: test-builder}\nscenes: ";
  EXPECT_EQ(errors(methods + "[]\n"), "x.yaml:2:9: 'scenes' is empty; expected a list of scenes, such as '[sibenik-ogre]'");
  EXPECT_EQ(errors(methods + "sibenik\n"),
            "x.yaml:2:9: 'scenes' is the text 'sibenik'; expected a list of scenes, such as '[sibenik-ogre]'");
  EXPECT_EQ(errors(methods + "[sibenik-orge]\n"),
            "x.yaml:2:10: there is no scene 'sibenik-orge'; expected a name that 'raystudy list scenes' shows; did you mean "
            "'sibenik-ogre'?");
  EXPECT_EQ(errors(methods + "[terrain]\n"),
            "x.yaml:2:10: scene 'terrain' is made to measure and has no triangle count; expected a count, such as 'terrain: "
            "{triangles: "
            "100000}'");
  EXPECT_EQ(errors(methods + "[terrain: {seed: 2}]\n"),
            "x.yaml:2:10: scene 'terrain' is made to measure and has no triangle count; expected a count, such as 'terrain: "
            "{triangles: "
            "100000}'");
  EXPECT_EQ(errors(methods + "[terrain: {triangles: 10}]\n"),
            "x.yaml:2:31: 'triangles' is the integer 10; expected an integer in [1000, 100000000]");
  EXPECT_EQ(errors(methods + "[terrain: {triangles: []}]\n"),
            "x.yaml:2:31: 'triangles' sweeps over an empty list; expected at least one value");
  EXPECT_EQ(errors(methods + "[sibenik-ogre: {triangles: 1000}]\n"),
            "x.yaml:2:25: scene 'sibenik-ogre' has no key 'triangles'; expected one of label");
  EXPECT_EQ(errors(methods + "[conference, conference]\n"),
            "x.yaml:2:22: two scenes are called 'conference'; expected a 'label' for one of them; the first is on line 2");
  EXPECT_EQ(errors(methods + "[[conference]]\n"),
            "x.yaml:2:10: a scene is a list; expected NAME or 'NAME: {triangles, seed, label}'");
  EXPECT_EQ(errors(methods + "[{a: 1, b: 2}]\n"),
            "x.yaml:2:10: a scene is a map of 2 keys; expected NAME or 'NAME: {triangles, seed, label}'");
  EXPECT_EQ(errors(methods + "[conference: {label: a/b}]\n"),
            "x.yaml:2:10: the name 'a/b' cannot be used; expected at least one letter, and none of / [ ] ,");
}

TEST(ReadErrors, MethodNames) {
  EXPECT_EQ(errors(with_methods("[a]")),
            "x.yaml:2:10: 'methods' is a list; expected a map of name to pipeline, such as 'sah: {builder: sweep-sah}'");
  EXPECT_EQ(errors(with_methods("{}")),
            "x.yaml:2:10: 'methods' is empty; expected a map of name to pipeline, such as 'sah: {builder: sweep-sah}'");
  EXPECT_EQ(errors(with_methods("{a: [x]}")), "x.yaml:2:14: method 'a' is a list; expected a map");
  EXPECT_EQ(errors(with_methods("{a: {optimize: test-optimizer}}")),
            "x.yaml:2:11: method 'a' has no builder; expected 'builder' or 'from'");
  EXPECT_EQ(errors(with_methods("{a: tst-builder}")), "x.yaml:2:14: there is no builder 'tst-builder'; expected one of " +
                                                          names(Role::builder) + "; did you mean 'test-builder'?");
  EXPECT_EQ(errors(with_builder("test-optimizer")),
            "x.yaml:2:24: 'test-optimizer' is an optimizer; expected a builder: one of " + names(Role::builder));
  EXPECT_EQ(
      errors(with_builder("{test-builder: {}, test-foreign: {}}")),
      "x.yaml:2:24: the builder is a map of 2 keys; expected NAME or {NAME: {parameter: value}}, with the name of a builder");
  EXPECT_EQ(errors(with_builder("[]")), "x.yaml:2:24: 'builder' sweeps over an empty list; expected at least one builder");
  EXPECT_EQ(
      errors(with_methods("{a: {builder: test-builder, optimise: test-optimizer}}")),
      "x.yaml:2:38: method 'a' has no key 'optimise'; expected one of from, builder, optimize, update, encode, tracers, threads; "
      "did you mean "
      "'optimize'?");
  EXPECT_EQ(errors(with_methods("{a/b: test-builder}")),
            "x.yaml:2:11: the name 'a/b' cannot be used; expected at least one letter, and none of / [ ] ,");
}

TEST(ReadErrors, Parameters) {
  EXPECT_EQ(errors(with_builder("{test-builder: {bin: 3}}")),
            "x.yaml:2:40: builder 'test-builder' has no parameter 'bin'; expected one of bins, centres, parallel, note, "
            "heuristic; did you "
            "mean 'bins'?");
  EXPECT_EQ(errors(with_builder("{test-foreign: {bin: 3}}")),
            "x.yaml:2:40: builder 'test-foreign' has no parameter 'bin'; expected none");
  EXPECT_EQ(errors(with_builder("{test-builder: 3}")),
            "x.yaml:2:39: the parameters of builder 'test-builder' are the integer 3; expected a map");
  EXPECT_EQ(errors(with_builder("{test-builder: {bins: 1}}")),
            "x.yaml:2:46: builder 'test-builder': parameter 'bins' is the integer 1; expected an integer in [2, 256]");
  EXPECT_EQ(errors(with_builder("{test-builder: {bins: x, centres: centrod, parallel: yes}}")),
            "x.yaml:2:46: builder 'test-builder': parameter 'bins' is the text 'x'; expected an integer in [2, 256]\n"
            "x.yaml:2:58: builder 'test-builder': parameter 'centres' is the text 'centrod'; expected one of box, centroid; did "
            "you mean "
            "'centroid'?\n"
            "x.yaml:2:77: builder 'test-builder': parameter 'parallel' is the text 'yes'; expected true or false");
  EXPECT_EQ(errors(with_builder("{test-builder: {note: {a: b}}}")),
            "x.yaml:2:46: builder 'test-builder': parameter 'note' is a map; expected a text");
  EXPECT_EQ(errors(with_builder("{test-builder: {heuristic: surface-are}}")),
            "x.yaml:2:51: there is no heuristic 'surface-are'; expected one of " + names(Role::heuristic) +
                "; did you mean 'surface-area'?");
  EXPECT_EQ(errors(with_methods("{a: {builder: test-builder, optimize: [test-optimizer: {percent: 0}]}}")),
            "x.yaml:2:75: optimizer 'test-optimizer': parameter 'percent' is the integer 0; expected a number in (0, 100]");
}

TEST(ReadErrors, Sweeps) {
  EXPECT_EQ(errors(with_builder("{test-builder: {bins: []}}")),
            "x.yaml:2:46: builder 'test-builder': parameter 'bins' sweeps over an empty list; expected at least one value");
  EXPECT_EQ(errors(with_builder("{test-builder: {bins: [4, 8, 4]}}")),
            "x.yaml:2:53: builder 'test-builder': parameter 'bins' sweeps over 4 twice; expected each value once");
  EXPECT_EQ(errors(with_builder("{test-builder: {bins: [4, [8]]}}")),
            "x.yaml:2:50: builder 'test-builder': parameter 'bins' is a list; expected an integer in [2, 256]");
  std::string many = "2";
  for (int i = 3; i <= 256; ++i) many += fmt::format(", {}", i);
  std::string notes = "n0";
  for (int i = 1; i < 50; ++i) notes += fmt::format(", n{}", i);
  EXPECT_EQ(errors("scenes: [sibenik-ogre]\nmethods:\n  a:\n    builder:\n      test-builder:\n        bins: [" + many +
                   "]\n        note: [" + notes + "]\n"),
            "x.yaml:7:9: the sweep of builder 'test-builder' has 12750 points; expected at most 10000");
  EXPECT_EQ(
      errors(
          "scenes: [sibenik-ogre]\nmethods:\n  a:\n    builder: {test-builder: {bins: [" + many +
          "]}}\n    optimize: [test-optimizer: {bins: [1, 2, 3, 4, 5, 6, 7, 8]}, test-optimizer: {bins: [1, 2, 3, 4, 5, 6]}]\n"),
      "x.yaml:3:3: the sweep of method 'a' has more than 10000 points; expected fewer values in its lists");
}

TEST(ReadErrors, Animations) {
  const std::string plays = good + "animation: {frames: 5}\n";
  EXPECT_EQ(errors(plays), "x.yaml:2:11: method 'a' does not say how its tree follows the animation; expected 'update', one of " +
                               names(Role::updater));
  EXPECT_EQ(errors(with_methods("{a: {builder: test-builder, update: test-updater}}")),
            "x.yaml:2:46: method 'a' has 'update', and the experiment plays no animation; expected 'animation: {frames: 50}' in "
            "the experiment");
  EXPECT_EQ(
      errors(with_methods("{a: {builder: test-foreign, update: test-updater}}") + "animation: {}\n"),
      "x.yaml:2:46: updater 'test-updater' cannot take what builder 'test-foreign' makes ('foreign'); expected a builder of "
      "'bvh2'");
  EXPECT_EQ(errors(good + "animation: {frames: 0}\n").substr(0, 81),
            "x.yaml:2:11: method 'a' does not say how its tree follows the animation; expected");
  EXPECT_EQ(errors(with_methods("{a: {builder: test-builder, update: test-updater}}") + "animation: {frames: 0}\n"),
            "x.yaml:3:21: 'frames' is the integer 0; expected an integer in [1, 1000000]");
  EXPECT_EQ(errors(good + "tables: {t: {rows: method, columns: [average_cost]}}\n"),
            "x.yaml:3:38: column 'average_cost' asks for 'average_cost', and the experiment plays no animation; expected "
            "'animation: {frames: 50}' in the experiment");
}

TEST(ReadErrors, From) {
  EXPECT_EQ(errors(with_methods("{a: {from: b}, bb: test-builder}")),
            "x.yaml:2:21: there is no method 'b' in this experiment; expected one of a, bb");
  EXPECT_EQ(errors(with_methods("{a: {from: [a]}}")), "x.yaml:2:21: 'from' is a list; expected the name of a method");
  EXPECT_EQ(errors(with_methods("{a: {from: a}}")),
            "x.yaml:2:21: 'from' goes round in a circle: a → a; expected a chain that ends in a builder");
  EXPECT_EQ(errors(with_methods("{a: {from: b}, b: {from: c}, c: {from: b}}")),
            "x.yaml:2:49: 'from' goes round in a circle: b → c → b; expected a chain that ends in a builder");
}

TEST(ReadErrors, StagesThatDoNotFit) {
  EXPECT_EQ(
      errors(with_methods("{a: {builder: test-foreign, optimize: [test-optimizer]}}")),
      "x.yaml:2:49: optimizer 'test-optimizer' cannot take what builder 'test-foreign' makes ('foreign'); expected a builder of "
      "'bvh2'");
  EXPECT_EQ(errors(with_methods("{a: {builder: test-foreign, encode: test-encoder}}")),
            "x.yaml:2:46: encoder 'test-encoder' cannot take what builder 'test-foreign' makes ('foreign'); expected a builder "
            "of 'bvh2'");
}

TEST(ReadErrors, Tracers) {
  const std::string rays = "workloads: [test-rays]\n";
  EXPECT_EQ(errors(good + rays), "x.yaml:3:12: there are workloads but no tracers; expected 'tracers', such as '[scalar]'");
  EXPECT_EQ(errors(good + "tracers: [test-tracer]\n"),
            "x.yaml:3:10: there are tracers but no workloads; expected 'workloads', such as '[primary]'");
  EXPECT_EQ(errors(good + rays + "tracers: test-tracer\n"),
            "x.yaml:4:10: 'tracers' is the text 'test-tracer'; expected a map of label to tracer, or a list of them");
  EXPECT_EQ(errors(good + rays + "tracers: [test-tracer, test-tracer]\n"),
            "x.yaml:4:24: two tracers are called 'test-tracer'; expected 'LABEL: test-tracer' for one of them, in a map; the "
            "first is on "
            "line 4");
  EXPECT_EQ(errors(good + rays + "tracers: [test-wide-tracer]\n"),
            "x.yaml:2:11: no tracer of this experiment can trace what method 'a' makes ('bvh2'); expected such a tracer in "
            "'tracers', or "
            "'tracers: []' in the method to build it only");
  EXPECT_EQ(errors(good + rays + "tracers: [test-tracer, test-wide-tracer]\n"),
            "x.yaml:4:24: tracer 'test-wide-tracer' traces no method of this experiment; expected a method that makes 'wide' and "
            "does not "
            "leave this tracer out");
  const std::string both = rays + "tracers: {t: test-tracer, w: test-wide-tracer}\n";
  EXPECT_EQ(errors(with_methods("{a: {builder: test-builder, tracers: [w]}}") + both),
            "x.yaml:2:48: tracer 'w' cannot trace what method 'a' makes ('bvh2'); expected a tracer of 'bvh2'");
  EXPECT_EQ(errors(with_methods("{a: {builder: test-builder, tracers: [x]}}") + both),
            "x.yaml:2:48: there is no tracer 'x' in this experiment; expected one of t, w");
  EXPECT_EQ(errors(with_methods("{a: {builder: test-builder, tracers: {}}}") + both),
            "x.yaml:2:47: 'tracers' is a map; expected a name or a list of names");
  EXPECT_EQ(errors(with_methods("{a: {builder: test-builder, tracers: [[t]]}}") + both),
            "x.yaml:2:48: 'tracers' holds a list; expected a name");
}

TEST(ReadErrors, Metrics) {
  EXPECT_EQ(errors(good + "metrics: cost\n"), "x.yaml:3:10: 'metrics' is the text 'cost'; expected a list of metrics");
  EXPECT_EQ(errors(good + "metrics: [nonsense]\n"),
            "x.yaml:3:11: there is no metric 'nonsense'; expected one of " + names(Role::metric));
  EXPECT_EQ(
      errors(good + "metrics: [test-metric]\n"),
      "x.yaml:3:11: metric 'test-metric' takes 'wide', which no method of this experiment makes; expected a metric of what the "
      "methods make");
}

TEST(ReadErrors, WhatIsWrongItselfIsNotMissedElsewhere) {
  EXPECT_EQ(errors("scenes: [nowhere, conference]\nmethods: {a: test-bilder, b: test-builder}\n"
                   "tables: {t: {only: [nowhere], columns: {c: {metric: triangles, method: a}}}}\n"),
            "x.yaml:1:10: there is no scene 'nowhere'; expected a name that 'raystudy list scenes' shows\n"
            "x.yaml:2:14: there is no builder 'test-bilder'; expected one of " +
                names(Role::builder) + "; did you mean 'test-builder'?");
}

TEST(ReadErrors, AllOfAFileAtOnceInItsOrder) {
  EXPECT_EQ(errors("scenes: [nowhere]\nseed: x\nmethods:\n  a: nobody\n  a: test-builder\nfoo: 1\n"),
            "x.yaml:1:10: there is no scene 'nowhere'; expected a name that 'raystudy list scenes' shows\n"
            "x.yaml:2:7: 'seed' is the text 'x'; expected an integer >= 0\n"
            "x.yaml:4:6: there is no builder 'nobody'; expected one of " +
                names(Role::builder) +
                "\nx.yaml:5:3: key 'a' stands a second time; expected each key once; the first is on line 4\n"
                "x.yaml:6:1: the experiment has no key 'foo'; expected one of title, paper, seed, threads, repetitions, warm_up, "
                "timeout, "
                "memory_limit, cost, animation, scenes, tracers, workloads, methods, metrics, tables, figures");
}

}  // namespace
}  // namespace raystudy
