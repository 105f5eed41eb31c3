#version 460
#extension GL_GOOGLE_include_directive : require
#include "methods/vulkan/shaders/ploc.glsl"

// Pairs of a round of merges to their place depth first: which their parent, of a later round, has left. Once for the root alone.
layout(constant_id = 1) const bool root = false;

layout(push_constant, scalar) uniform Push {
  Nodes from;
  Uints leaves;
  Places places;
  Nodes to;
  Uints order;
  Uints triangles;
  Boxes clusters;  // the last, and its link
  Uints links;
  uint first;  // pair
  uint end;
} push;

void write(Node node, uint slot, Place below) {
  if (node.count > 0) {
    push.triangles.at[below.begin] = push.order.at[node.first];
    node.first = below.begin;
  } else {
    push.places.at[node.first / 2] = below;
    node.first = below.pair;
  }
  push.to.at[slot] = node;
}

void main() {
  const uint pair = push.first + invocation_index();
  if (pair >= push.end) return;
  if (root) {
    write(node_of(push.clusters.at[0], push.links.at[0]), 0, Place(2, 0));
    push.to.at[1] = Node(Box(vec3(0), vec3(0)), 0, 0);
    return;
  }
  const Place place = push.places.at[pair];
  const Node left = push.from.at[2 * pair];
  const uint below_left = left.count > 0 ? 1 : push.leaves.at[left.first / 2];
  write(left, place.pair, Place(place.pair + 2, place.begin));
  write(push.from.at[2 * pair + 1], place.pair + 1, Place(place.pair + 2 * below_left, place.begin + below_left));
}
