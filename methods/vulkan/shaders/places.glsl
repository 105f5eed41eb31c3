// Places in Morton order that one invocation looks at, and that share a mask.
const uint places = 8;
