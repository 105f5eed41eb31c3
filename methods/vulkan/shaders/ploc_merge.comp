#version 460
#extension GL_GOOGLE_include_directive : require
#include "methods/vulkan/shaders/ploc.glsl"

// The clusters that stay move together; those that are merged become a pair of siblings and its parent.
layout(push_constant, scalar) uniform Push {
  Boxes clusters;
  Uints links;
  Boxes next_clusters;
  Uints next_links;
  Uints nearest;
  Uints ranks;  // prefix sums of the marks
  Nodes nodes;
  Uints leaves;  // by pair: how many are below it
  uint count;
  uint triangles;
  uint merges;  // before this round
} push;

uint leaves_of(uint link) { return (link & leaf_bit) != 0 ? 1 : push.leaves.at[link / 2]; }

void main() {
  const uint i = invocation_index();
  if (i >= push.count) return;
  const uint to = push.ranks.at[i];
  if (push.ranks.at[i + 1] == to) return;
  Box box = push.clusters.at[i];
  uint link = push.links.at[i];
  const uint merge = push.ranks.at[push.count + i];
  if (push.ranks.at[push.count + i + 1] != merge) {
    const uint j = push.nearest.at[i];
    const Box other = push.clusters.at[j];
    const uint other_link = push.links.at[j];
    const uint pair = 2 * (push.triangles - 1 - (push.merges + merge - push.ranks.at[push.count]));
    push.nodes.at[pair] = node_of(box, link);
    push.nodes.at[pair + 1] = node_of(other, other_link);
    push.leaves.at[pair / 2] = leaves_of(link) + leaves_of(other_link);
    box = united(box, other);
    link = pair;
  }
  push.next_clusters.at[to] = box;
  push.next_links.at[to] = link;
}
