#pragma once

#include "harness/spec/reading.h"

namespace raystudy {

// The sections of an experiment. Each fills its part of the plan from its node and reports what is wrong with it.

/// `scenes`: a list of names, or of `NAME: {triangles, seed, label}` for generators; a list of triangle counts is a sweep.
void read_scenes(Reading& reading, const YamlNode& node, Plan& plan);
/// `tracers` and `workloads`: a map of label to method, or a list of methods whose labels are their names.
void read_tracers(Reading& reading, const YamlNode& node, Plan& plan);
void read_workloads(Reading& reading, const YamlNode& node, Plan& plan);
/// `methods`: a map of label to `{from, builder, optimize, encode, tracers}`, or to a builder's name. After `read_tracers`.
void read_pipelines(Reading& reading, const YamlNode& node, Plan& plan);
/// `metrics`: a list of metrics; without the section every one that is registered. After `read_pipelines`.
void read_metrics(Reading& reading, const YamlNode* node, Plan& plan);
/// `tables` and `figures`: maps of name to what they show. After all others.
void read_tables(Reading& reading, const YamlNode& node, Plan& plan);
void read_figures(Reading& reading, const YamlNode& node, Plan& plan);

/// Names of all scenes that can be asked for: generators first, then the catalog's.
[[nodiscard]] std::vector<std::string> known_scene_names();

}  // namespace raystudy
