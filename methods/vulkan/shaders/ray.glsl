// Rays made ready for boxes and triangles: the arithmetic of harness/geometry/slab.h and watertight.h, operation by operation.
// `precise` keeps products and sums apart, on which both rest.

const float infinity = 1.0 / 0.0;
const float largest_float = 3.402823466e+38;

struct TracedRay {
  vec3 origin;
  vec3 direction;
  float tmin;
  // Boxes: conservative slabs (Ize 2013; Woop, Benthin, Wald 2013, Section 4).
  vec3 origin_near;
  vec3 origin_far;
  vec3 inverse_near;
  vec3 inverse_far;
  bvec3 negative;
  double scale;  // t in which boxes are entered and left, over t of the ray; a power of two
  // Triangles: space sheared along the direction's longest axis.
  uint along;
  float shear_across;
  float shear_up;
};

bool is_finite(vec3 v) {
  const uvec3 exponents = floatBitsToUint(v) & 0x7f800000u;
  return all(notEqual(exponents, uvec3(0x7f800000u)));
}

// Correctly rounded, which the division of floats need not be.
float quotient(float a, float b) { return float(double(a) / double(b)); }

// 2^exponent for -1022 <= exponent <= 1023.
double power_of_two(int exponent) { return packDouble2x32(uvec2(0, uint(exponent + 1023) << 20)); }

// (across, up, along): the axes of the sheared space, whose third is that of the longest component of the direction.
vec3 turned(vec3 v, uint along) { return along == 2 ? v.xyz : along == 1 ? v.zxy : v.yzx; }

// False for a ray that hits nothing whatever the scene.
bool prepare(vec3 origin, vec3 direction, float tmin, float tmax, vec3 lower, vec3 upper, out TracedRay ray) {
  const vec3 magnitude = abs(direction);
  ray.along = magnitude.x > magnitude.y ? (magnitude.x > magnitude.z ? 0 : 2) : (magnitude.y > magnitude.z ? 1 : 2);
  const vec3 sheared = turned(direction, ray.along);
  ray.shear_across = quotient(sheared.x, sheared.z);
  ray.shear_up = quotient(sheared.y, sheared.z);
  ray.origin = origin;
  ray.direction = direction;
  ray.tmin = tmin;
  const float longest = abs(sheared.z);
  if (!is_finite(origin) || !is_finite(direction) || !(longest > 0) || !(tmin >= 0 && tmin <= tmax)) return false;

  // Brings a direction of extreme length near 1, so that no reciprocal is denormal or overflows.
  ray.scale = 1;
  vec3 d = direction;
  const float extreme = uintBitsToFloat(187u << 23);  // 2^60
  if (!(longest > 1 / extreme && longest < extreme)) {
    const int exponent = int(unpackDouble2x32(double(longest)).y >> 20) - 1023;
    ray.scale = power_of_two(exponent);
    d = vec3(dvec3(direction) * power_of_two(-exponent));
  }
  const precise vec3 reach = max(abs(lower - origin), abs(upper - origin));
  const float farthest = max(max(reach.x, reach.y), reach.z);
  // Woop's 5 · 2^-24 and one for this sum; then the rounding of origin ± error; then what underflows.
  const float smallest_normal = uintBitsToFloat(0x00800000u);
  const precise vec3 error = (6.0 / 16777216.0) * (reach + farthest) + abs(origin) * (1.0 / 8388608.0) + smallest_normal;
  for (uint i = 0; i < 3; ++i) {
    const float inverse = quotient(1, d[i]);
    const bool negative = (floatBitsToUint(d[i]) & 0x80000000u) != 0;
    ray.negative[i] = negative;
    const precise float less = origin[i] - error[i];
    const precise float more = origin[i] + error[i];
    ray.origin_near[i] = negative ? less : more;
    ray.origin_far[i] = negative ? more : less;
    const precise float near_inverse = inverse * (1 - 1.0 / 4194304.0);
    const precise float far_inverse = inverse * (1 + 1.0 / 4194304.0);
    // The reciprocal of a tiny component overflows: entering must not come out later than it is.
    const bool overflows = d[i] != 0 && abs(inverse) == infinity;
    ray.inverse_near[i] = overflows ? (negative ? -largest_float : largest_float) : near_inverse;
    ray.inverse_far[i] = far_inverse;
  }
  return true;
}

// t of the ray → t in which boxes are entered and left.
float scaled(TracedRay ray, float t) { return float(double(t) * ray.scale); }

// Narrows [near, far] of two boxes to the slab between their planes. A NaN, a ray in a face, narrows nothing.
void narrow(TracedRay ray, uint axis, vec2 lower, vec2 upper, inout vec2 near, inout vec2 far) {
  const bool negative = ray.negative[axis];
  const precise vec2 t_near = ((negative ? upper : lower) - ray.origin_near[axis]) * ray.inverse_near[axis];
  const precise vec2 t_far = ((negative ? lower : upper) - ray.origin_far[axis]) * ray.inverse_far[axis];
  near = mix(near, t_near, greaterThan(t_near, near));
  far = mix(far, t_far, lessThan(t_far, far));
}

double edge(vec3 x, vec3 y, uint i, uint j) {
  const precise double value = double(x[j]) * double(y[i]) - double(y[j]) * double(x[i]);
  return value;
}

// True where the ray meets the triangle a, b, c at a finite t in [tmin, tmax]; `hit` is t, u, v. The signs of the rounded edge
// functions rule out most triangles; the others are decided in double, in which the products of floats are exact.
bool intersect(TracedRay ray, vec3 a, vec3 b, vec3 c, float tmax, out vec3 hit) {
  const vec3 ra = turned(a - ray.origin, ray.along);
  const vec3 rb = turned(b - ray.origin, ray.along);
  const vec3 rc = turned(c - ray.origin, ray.along);
  const vec3 z = vec3(ra.z, rb.z, rc.z);
  const precise vec3 x = vec3(ra.x, rb.x, rc.x) - ray.shear_across * z;
  const precise vec3 y = vec3(ra.y, rb.y, rc.y) - ray.shear_up * z;
  const precise vec3 edges = x.zxy * y.yzx - y.zxy * x.yzx;
  if (any(lessThan(edges, vec3(0))) && any(greaterThan(edges, vec3(0)))) return false;
  const double e0 = edge(x, y, 1, 2);
  const double e1 = edge(x, y, 2, 0);
  const double e2 = edge(x, y, 0, 1);
  if ((e0 < 0 || e1 < 0 || e2 < 0) && (e0 > 0 || e1 > 0 || e2 > 0)) return false;
  const precise double area = e0 + e1 + e2;
  if (!(area != 0)) return false;  // seen edge-on, or of no area
  const double along = double(turned(ray.direction, ray.along).z);
  const precise double t = (e0 * double(z.x) + e1 * double(z.y) + e2 * double(z.z)) / (area * along);
  hit = vec3(float(t), float(e1 / area), float(e2 / area));
  return hit.x >= ray.tmin && hit.x <= tmax && hit.x < infinity;
}
