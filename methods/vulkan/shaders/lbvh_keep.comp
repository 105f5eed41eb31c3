#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "methods/vulkan/shaders/scene.glsl"
#include "methods/vulkan/shaders/places.glsl"

// Behind which places leaves are parted: where a node of more than max_leaf triangles is split, and where the split is less deep
// than least_depth. A node has more than max_leaf triangles if it has max_leaf splits in a row among which its own is the least
// deep; so the splits that are kept are those that are the least deep of any so many in a row. An invocation looks at a few places
// that stand together, in registers. Depths are never equal in a row without a lesser one between.
layout(constant_id = 1) const uint max_leaf = 1;
layout(constant_id = 2) const uint least_depth = 0;

layout(push_constant, scalar) uniform Push {
  Uints depths;
  Uints masks;
  Uints counts;
  uint count;
} push;

const uint reach = max_leaf - 1;

void main() {
  const uint group = invocation_index();
  const uint begin = group * places;
  if (begin >= push.count) return;
  int depth[places + 2 * reach];
  int least[places + reach];
  [[unroll]] for (uint k = 0; k < places + 2 * reach; ++k) {
    const int i = int(begin + k) - int(reach);
    depth[k] = i >= 0 && i < int(push.count) - 1 ? int(push.depths.at[i]) : -1;
  }
  [[unroll]] for (uint k = 0; k < places + reach; ++k) {
    int l = depth[k];
    [[unroll]] for (uint j = 1; j < max_leaf; ++j) l = min(l, depth[k + j]);
    least[k] = l;
  }
  uint mask = 0;
  [[unroll]] for (uint k = 0; k < places; ++k) {
    int most = least[k];
    [[unroll]] for (uint j = 1; j < max_leaf; ++j) most = max(most, least[k + j]);
    const int own = depth[k + reach];
    if (own >= 0 && (own == most || own < int(least_depth))) mask |= 1u << k;
  }
  push.masks.at[group] = mask;
  push.counts.at[group] = bitCount(mask);
}
