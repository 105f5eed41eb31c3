#version 460
#extension GL_GOOGLE_include_directive : require
#include "methods/vulkan/shaders/treelets.glsl"

// The first level: the root over all treelets, in order.
layout(push_constant, scalar) uniform Push {
  Uints order;
  Tasks tasks;
  Queues queues;
  Places places;
  uint treelets;
} push;

void main() {
  const uint t = invocation_index();
  if (t < push.treelets) push.order.at[t] = t;
  if (t != 0) return;
  const bool several = push.treelets > 1;
  push.tasks.at[0] = Task(0, 0, push.treelets, 0, 0);
  if (!several) push.places.at[0] = Place(0, 0, 0);
  push.queues.at[0] = Queue(uvec3(several ? 1 : 0, 1, 1), several ? 1 : 0);
  push.queues.at[1] = Queue(uvec3(0, 1, 1), 0);
}
