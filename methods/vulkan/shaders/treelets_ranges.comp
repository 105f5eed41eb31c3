#version 460
#extension GL_GOOGLE_include_directive : require
#include "methods/vulkan/shaders/scene.glsl"

// The first leaf of each treelet.
layout(push_constant, scalar) uniform Push {
  Uints treelets;       // of each leaf; of `count` the last
  Uints treelet_first;  // one more than there are treelets
  uint count;
} push;

void main() {
  const uint i = invocation_index();
  if (i >= push.count) return;
  const uint t = push.treelets.at[i];
  if (i == 0) push.treelet_first.at[0] = 0;
  if (i + 1 == push.count) {
    push.treelet_first.at[t + 1] = push.count;
  } else if (push.treelets.at[i + 1] != t) {
    push.treelet_first.at[t + 1] = i + 1;
  }
}
