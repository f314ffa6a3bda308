// Advances every point by one event: from the answer to its query to its next query. The method, its names and its numbers
// are those of host/cpu/flow_path.cpp; the same operations in the same order, all of them precise, so that both give the same
// bits. The candidates are those of closest.comp; among them the nearest face is decided in double precision.
//
// Software devices run every branch under a mask, and what is called is inlined. So there is one loop with one place that
// looks at the contacts; what it looks for stands in `look_for`, and what follows from the view stands below in the order
// in which one thing may lead to the next. A point that is not through after push.turns goes on in the next dispatch.
//
// Most turns are those of steps off two contacts with a face each: sheets. For them there is a kernel of their own (FLOW_SHEET_ID)
// without the rest, with three frames fetched once; a point that is to do something else leaves it for the other kernel, which
// in turn does nothing that this one can.
//
// Software devices also end loops early without a word: every loop leaves a trace of having run to its end.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "shaders/closest.h"
#include "shaders/flow.h"

layout(local_size_x_id = COWGPU_LOCAL_SIZE_ID) in;
layout(constant_id = FLOW_SHEET_ID) const bool sheet = false;

layout(binding = FLOW_FRAMES) uniform usamplerBuffer frames;
layout(std430, binding = FLOW_LANES) readonly buffer Lanes { uvec2 lanes[]; };
layout(std430, binding = FLOW_CANDIDATES) readonly buffer Candidates {
  uint total;
  uint candidates[];
};
layout(std430, binding = FLOW_FACES) readonly buffer Faces { uint face_of[]; };
layout(std430, binding = FLOW_ENTRIES) readonly buffer Entries { FlowEntry entries[]; };
layout(std430, binding = FLOW_NUMBERS) buffer Numbers { double numbers[]; };
layout(std430, binding = FLOW_WORDS) buffer Words { uint words[]; };
layout(std430, binding = FLOW_POINTS) buffer Points { FlowPoint points[]; };
layout(push_constant) uniform Push { FlowPush push; };

// Flags of host/flow.hpp.
const uint slid_flag = 1, stationary_flag = 2, unfinished_flag = 16, notch_flag = 64;

// Lengths relative to the diagonal, and the last to the distance, as in host/cpu/flow_path.cpp.
const double rounding = 1e-13lf, tie = 1e-11lf, apart = 1e-9lf, off_surface = 1e-7lf, digits = 4e-15lf;
const double same_point = 1e-6lf, near_share = 1e3lf;

// What the view is for.
const uint for_last = 0, for_lift = 1, for_ray = 2, for_restart = 3, for_check = 4, for_contacts = 5, for_velocity = 6,
           for_line = 7, for_stage = 8, for_balance = 9, for_tie = 10, for_gap = 11, for_nearer = 12;

uint place;    // of the point
uint planned, done; // iterations of inner loops

// The point.
dvec3 x;
double recorded; // time of FLOW_RECORDED; x is its place
double t, carried; // carried: the step that the error of the last slide allows
uint flags, marks, idle, rounds, queries, events, steps;
uint count, counts; // contacts, and four bits each their faces
uint faces[FLOW_CONTACTS * FLOW_CONTACT_FACES];
dvec3 slide_place;
double slide_time;

// The ball of a ray.
dvec3 ball_foot, ball_normal, touched;
double ball_distance, radius, limit;
uint ball_face, hit, ball_rounds;

// The step of a slide and the search for a tie.
dvec3 slide_end, k1, k2, k3, k4, k5, k6;
double from_distance, step_length, next_step, most, tried, low, high, low_gap, high_gap;
uint nearer, ties, stage, tries, round_of_tie, round_of_balance;
int side;
bool line, in_tie;

// The query.
bool asking;
uint phase;
dvec3 asked;

// The view.
uint look_for, extra;
dvec3 at;
double normal_x[FLOW_CONTACTS], normal_y[FLOW_CONTACTS], normal_z[FLOW_CONTACTS];
double point_x[FLOW_CONTACTS], point_y[FLOW_CONTACTS], point_z[FLOW_CONTACTS];
double distances[FLOW_CONTACTS], weights[FLOW_CONTACTS];
double feet[FLOW_CONTACTS * FLOW_CONTACT_FACES]; // distances of the contacts' faces
uint nearest_face;                                       // of the first contact
dvec3 velocity, extra_point;
double view_distance, extra_distance;
bool all_inside;

// A triangle's frame in its plane.
struct Frame {
  dvec3 a, u, v;
  dvec4 c; // length, cx, cy, c_inverse
  dvec3 e; // ex, ey, e_inverse
};

// On a sheet: the two contacts and what follows from them.
Frame frame_0, frame_1, frame_extra;
dvec3 normal_0, normal_1, point_0, point_1;
double distance_0, distance_1;

dvec2 texel(int i) {
  const uvec4 word = texelFetch(frames, i);
  return dvec2(packDouble2x32(word.xy), packDouble2x32(word.zw));
}

Frame fetch_frame(uint face) {
  const int i = int(face) * FLOW_FRAME_TEXELS;
  const dvec2 t0 = texel(i), t1 = texel(i + 1), t2 = texel(i + 2), t3 = texel(i + 3), t4 = texel(i + 4);
  const dvec2 t6 = texel(i + 6), t7 = texel(i + 7), t8 = texel(i + 8), t9 = texel(i + 9);
  return Frame(dvec3(t0, t1.x), dvec3(t1.y, t2), dvec3(t3, t4.x), dvec4(t6, t7), dvec3(t8, t9.x));
}

dvec3 frame_normal(uint face) {
  const int i = int(face) * FLOW_FRAME_TEXELS + 4;
  return dvec3(texel(i).y, texel(i + 1));
}

dvec3 face_normal(uint face) {
  const int i = int(face) * FLOW_FRAME_TEXELS + 9;
  return dvec3(texel(i).y, texel(i + 1));
}

precise double dot3(dvec3 a, dvec3 b) {
  precise double sum = a.x * b.x + (a.y * b.y + a.z * b.z);
  return sum;
}
precise double norm3(dvec3 a) {
  precise double length = sqrt(dot3(a, a));
  return length;
}
double least(double a, double b) { return b < a ? b : a; }
double most_of(double a, double b) { return a < b ? b : a; }
double within(double a, double low, double high) { return a < low ? low : high < a ? high : a; }

precise double small(double length, double distance) {
  precise double near = near_share * distance;
  precise double some = length * least(push.scale, near), none = digits * push.scale;
  return most_of(none, some);
}
precise double longer(double allowed, double error) {
  precise double factor = 0.9lf * sqrt(sqrt(allowed / error));
  return factor;
}

uint faces_of(uint contact) { return counts >> (4 * contact) & 15; }
void set_faces(uint contact, uint n) { counts = (counts & ~(15u << (4 * contact))) | n << (4 * contact); }

bool single_faces() { return count == FLOW_CONTACTS ? counts == 0x11111111u : ((counts ^ 0x11111111u) & ((1u << (4 * count)) - 1)) == 0; }

// Puts a face into a contact.
void add_face(uint contact, uint face) {
  const uint i = FLOW_CONTACT_FACES * contact;
  uint n = faces_of(contact);
  if ((n > 0 && faces[i] == face) || (n > 1 && faces[i + 1] == face) || (n > 2 && faces[i + 2] == face) ||
      (n > 3 && faces[i + 3] == face) || (n > 4 && faces[i + 4] == face) || (n > 5 && faces[i + 5] == face))
    return;
  if (n == FLOW_CONTACT_FACES) { // the oldest goes
    faces[i] = faces[i + 1];
    faces[i + 1] = faces[i + 2];
    faces[i + 2] = faces[i + 3];
    faces[i + 3] = faces[i + 4];
    faces[i + 4] = faces[i + 5];
    --n;
  }
  faces[i + n] = face;
  set_faces(contact, n + 1);
}

void add_contact(uint face) {
  if (count == FLOW_CONTACTS) return;
  faces[FLOW_CONTACT_FACES * count] = face;
  set_faces(count, 1);
  ++count;
}

// The nearest of a query's candidates: closest_of of host/cpu/closest_kernel.hpp.
precise double edge_distance2(double px, double py, double ex, double ey, double inverse) {
  precise double along = (px * ex + py * ey) * inverse;
  precise double s = within(along, 0.0lf, 1.0lf);
  precise double dx = px - s * ex, dy = py - s * ey;
  precise double d2 = dx * dx + dy * dy;
  return d2;
}

uint nearest(uint query, dvec3 p, out uint status) {
  const uvec2 lane = lanes[query / 4];
  status = FLOW_ASKS;
  if (lane.y == CLOSEST_CUT) status = FLOW_CUT;
  if (lane.y == CLOSEST_LEFT) status = FLOW_LEFT;
  const uint n = status == FLOW_ASKS ? lane.y : 0;
  uint best = FLOW_NO_FACE;
  precise double best_d2 = 0;
  planned += n;
  for (uint k = 0; k < n; ++k) {
    ++done;
    const uint word = candidates[lane.x + k];
    if ((word >> (CLOSEST_TRIANGLE_BITS + query % 4) & 1) == 0) continue;
    const uint face = face_of[word & ((1u << CLOSEST_TRIANGLE_BITS) - 1)];
    const Frame f = fetch_frame(face);
    precise dvec3 r = p - f.a;
    precise double px = dot3(f.u, r), py = dot3(f.v, r), pz = dot3(frame_normal(face), r);
    precise double dx = px - within(px, 0.0lf, f.c.x), xb = px - f.c.x;
    precise double d2 = dx * dx + py * py;
    d2 = least(d2, edge_distance2(px, py, f.c.y, f.c.z, f.c.w));
    d2 = least(d2, edge_distance2(xb, py, f.e.x, f.e.y, f.e.z));
    precise double c_left = f.c.y * py, c_right = f.c.z * px, e_left = f.e.y * xb, e_right = f.e.x * py;
    const bool inside = 0 < py && c_left < c_right && e_left < e_right;
    precise double height2 = pz * pz;
    d2 = inside ? height2 : height2 + d2;
    if (best == FLOW_NO_FACE || d2 < best_d2 || (d2 == best_d2 && face < best)) {
      best = face;
      best_d2 = d2;
    }
  }
  if (status == FLOW_ASKS && best == FLOW_NO_FACE) status = FLOW_CUT;
  return best;
}

// The closest point of a face: FlowSurface::foot.
void foot_on(Frame f, out dvec3 point, out double distance, out bool inside) {
  precise dvec3 r = at - f.a;
  precise double px = dot3(f.u, r), py = dot3(f.v, r), qx = px, qy = py;
  precise double xb = px - f.c.x;
  precise double c_side = f.c.y * py - f.c.z * px, e_side = f.e.x * py - f.e.y * xb;
  inside = py > 0 && c_side < 0 && e_side > 0;
  precise double ax = within(px, 0.0lf, f.c.x), a_gap = px - ax;
  precise double c_along = (px * f.c.y + py * f.c.z) * f.c.w;
  precise double sc = within(c_along, 0.0lf, 1.0lf), cx = sc * f.c.y, cy = sc * f.c.z;
  precise double cx_gap = px - cx, cy_gap = py - cy;
  precise double e_along = (xb * f.e.x + py * f.e.y) * f.e.z;
  precise double se = within(e_along, 0.0lf, 1.0lf), ex = se * f.e.x, ey = se * f.e.y;
  precise double ex_gap = xb - ex, ey_gap = py - ey, bx = f.c.x + ex;
  precise double a2 = a_gap * a_gap + py * py, c2 = cx_gap * cx_gap + cy_gap * cy_gap;
  precise double e2 = ex_gap * ex_gap + ey_gap * ey_gap;
  const bool by_c = c2 < a2;
  const bool by_e = e2 < (by_c ? c2 : a2);
  if (!inside) {
    qx = by_e ? bx : by_c ? cx : ax;
    qy = by_e ? ey : by_c ? cy : 0.0lf;
  }
  precise dvec3 q = f.a + qx * f.u + qy * f.v;
  precise dvec3 way = at - q;
  point = q;
  distance = norm3(way);
}

// least_norm_in_hull of host/reference/flow.hpp over the view's normals.
precise dvec3 normal_of(uint i) { return dvec3(normal_x[i], normal_y[i], normal_z[i]); }

void least_norm() {
  uint i = 0, j = 0, k = 0, ended = 0; // j = 0: the normal i alone; k = 0: i and j
  precise dvec3 found = dvec3(0);
  precise double wi = 1, wj = 0, wk = 0;
  const uint all = count;
  do {
    precise dvec3 ni = normal_of(i), a = normal_of(j) - ni, c = normal_of(k) - ni;
    precise double aa = dot3(a, a), cc = dot3(c, c), ac = dot3(a, c), ra = -dot3(a, ni), rc = -dot3(c, ni);
    precise double determinant = aa * cc - ac * ac, thin = 1e-18lf * aa * cc;
    precise double s = k == 0 ? ra / aa : (ra * cc - rc * ac) / determinant;
    precise double w = (rc * aa - ra * ac) / determinant;
    precise double both = s + w;
    const double margin = 1e-9lf, beyond = 1.0lf + margin;
    bool fits = true;
    if (k > 0) {
      fits = determinant > thin && !(s < -margin || w < -margin || both > beyond);
      found = ni + s * a + w * c;
      wi = 1 - s - w;
      wj = s;
      wk = w;
    } else if (j > 0) {
      fits = aa > 0 && !(s < 0 || s > 1);
      found = ni + s * a;
      wi = 1 - s;
      wj = s;
    } else {
      found = ni;
    }
    precise double enough = dot3(found, found) - 1e-10lf;
    uint other = 0;
    const uint others = fits ? all : 0;
    planned += others;
    while (other < others) {
      precise double along = dot3(normal_of(other), found);
      fits = fits && !(along < enough);
      ++other;
      ++done;
    }
    if (fits) {
      ended = 1;
    } else if (k > 0) { // the next in lexical order
      if (++k == all) {
        if (++j == all - 1) {
          ++i;
          j = i + 1;
        }
        k = j + 1;
      }
      if (k >= all) ended = 2;
    } else if (j > 0) {
      if (++j == all) {
        ++i;
        j = i + 1;
      }
      if (j >= all) {
        i = 0;
        j = 1;
        k = 2;
      }
    } else if (++i == all) {
      i = 0;
      j = 1;
    }
  } while (ended == 0);
  if (ended == 0) ++planned; // cut short
  uint c = 0;
  planned += all;
  do {
    weights[c] = ended == 2 ? 0.0lf : c == i ? wi : j > 0 && c == j ? wj : k > 0 && c == k ? wk : 0.0lf;
    ++done;
  } while (++c < all);
  velocity = ended == 2 ? dvec3(0) : found;
}

// The contacts as seen from `at` if `contacts`, and the face `extra` if there is one.
void look(bool contacts) {
  uint faces_left = extra != FLOW_NO_FACE ? 1 : 0;
  for (uint c = 0; c < FLOW_CONTACTS; ++c) faces_left += contacts && c < count ? faces_of(c) : 0;
  uint c = contacts ? 0 : count, k = 0;
  precise dvec3 best_point = dvec3(0), point, normal;
  precise double best = 0, distance;
  bool best_inside = false, inside;
  uint best_face = 0;
  all_inside = true;
  planned += faces_left;
  while (faces_left > 0) {
    const bool own = c < count;
    const uint face = own ? faces[FLOW_CONTACT_FACES * c + k] : extra;
    foot_on(fetch_frame(face), point, distance, inside);
    if (k == 0 || distance < best) {
      best_point = point;
      best = distance;
      best_inside = inside;
      best_face = face;
    }
    if (own) feet[FLOW_CONTACT_FACES * c + k] = distance;
    ++k;
    if (own && k == faces_of(c)) {
      precise dvec3 way = at - best_point;
      normal = way / best;
      if (!(best > 0)) normal = face_normal(best_face);
      normal_x[c] = normal.x;
      normal_y[c] = normal.y;
      normal_z[c] = normal.z;
      point_x[c] = best_point.x;
      point_y[c] = best_point.y;
      point_z[c] = best_point.z;
      distances[c] = best;
      view_distance = c == 0 ? best : least(view_distance, best);
      if (c == 0) nearest_face = best_face;
      all_inside = all_inside && best_inside;
      ++c;
      k = 0;
    } else if (!own) {
      extra_point = point;
      extra_distance = distance;
    }
    --faces_left;
    ++done;
  }
  if (contacts && count <= 2) {
    velocity = normal_of(0);
    weights[0] = 1;
    if (count == 2) {
      precise dvec3 sum = velocity + normal_of(1);
      velocity = sum / 2;
      weights[0] = 0.5lf;
      weights[1] = 0.5lf;
    }
  }
  if (contacts && count > 2) least_norm();
}

// The same on a sheet.
void look_on_sheet() {
  bool inside_0, inside_1, inside;
  foot_on(frame_0, point_0, distance_0, inside_0);
  foot_on(frame_1, point_1, distance_1, inside_1);
  foot_on(frame_extra, extra_point, extra_distance, inside);
  precise dvec3 way_0 = at - point_0, way_1 = at - point_1;
  precise dvec3 n0 = way_0 / distance_0, n1 = way_1 / distance_1;
  if (!(distance_0 > 0)) n0 = face_normal(faces[0]);
  if (!(distance_1 > 0)) n1 = face_normal(faces[FLOW_CONTACT_FACES]);
  normal_0 = n0;
  normal_1 = n1;
  precise dvec3 sum = n0 + n1;
  velocity = sum / 2;
  view_distance = least(distance_0, distance_1);
  all_inside = inside_0 && inside_1;
}

precise double active_distance() {
  if (sheet) return view_distance;
  precise double near = view_distance;
  bool some = false;
  planned += count;
  for (uint c = 0; c < count; ++c) {
    if (weights[c] > 1e-9lf) {
      near = some ? least(near, distances[c]) : distances[c];
      some = true;
    }
    ++done;
  }
  return near;
}

precise dvec3 point_of(uint i) { return dvec3(point_x[i], point_y[i], point_z[i]); }

// Drops contacts that are farther than the nearest, joins those with the same nearest point. True if there were such.
bool tidy() {
  if (sheet) {
    precise double far_off = view_distance + small(apart, view_distance), joined = same_point / 10 * view_distance;
    precise double between = norm3(point_0 - point_1);
    return distance_0 > far_off || distance_1 > far_off || !(between >= joined);
  }
  precise double far = view_distance + small(apart, view_distance);
  precise double join = same_point / 10 * view_distance, room = (far - view_distance) / 10;
  bool changed = false;
  uint kept = 0, from = 0, c = 0;
  const uint all = count, their = counts;
  planned += all;
  do {
    ++done;
    const bool dropped = distances[c] > far;
    uint same = 0;
    bool apart_from = !dropped && same < kept;
    while (apart_from) {
      precise double between = norm3(point_of(from >> (4 * same) & 15) - point_of(c));
      apart_from = between >= join;
      if (apart_from) apart_from = ++same < kept;
    }
    if (apart_from) ++planned; // cut short
    const uint n = their >> (4 * c) & 15;
    const bool own = !dropped && same == kept;
    if (own) {
      from |= c << (4 * kept);
      set_faces(kept, 0);
      ++kept;
    } else {
      changed = true;
    }
    const uint taken = dropped ? 0 : n;
    planned += taken;
    for (uint k = 0; k < taken; ++k) {
      ++done;
      precise double near = distances[c] + room;
      if (!own || n == 1 || feet[FLOW_CONTACT_FACES * c + k] <= near) add_face(same, faces[FLOW_CONTACT_FACES * c + k]);
    }
  } while (++c < all);
  count = kept;
  return changed;
}

// The slope k1 ... k6 with the weights of the next place, Dormand and Prince.
precise dvec3 slope() {
  const uint s = stage;
  precise double a = s == 1 ? 1.0lf / 5 : s == 2 ? 3.0lf / 40 : s == 3 ? 44.0lf / 45 : s == 4 ? 19372.0lf / 6561 :
                     s == 5 ? 9017.0lf / 3168 : 35.0lf / 384;
  precise double b = s == 2 ? 9.0lf / 40 : s == 3 ? 56.0lf / 15 : s == 4 ? 25360.0lf / 2187 : s == 5 ? 355.0lf / 33 : 0;
  precise double c = s == 3 ? 32.0lf / 9 : s == 4 ? 64448.0lf / 6561 : s == 5 ? 46732.0lf / 5247 :
                     s == 6 ? 500.0lf / 1113 : 0;
  precise double d = s == 4 ? -(212.0lf / 729) : s == 5 ? 49.0lf / 176 : s == 6 ? 125.0lf / 192 : 0;
  precise double e = s == 5 ? 5103.0lf / 18656 : s == 6 ? 2187.0lf / 6784 : 0;
  precise double f = s == 6 ? 11.0lf / 84 : 0;
  // The second weight is subtracted but in the first two rows.
  precise double b_signed = s == 2 ? b : -b;
  precise dvec3 sum = a * k1 + b_signed * k2 + c * k3 + d * k4 - e * k5 + f * k6;
  return sum;
}

void ask(uint why, dvec3 where) {
  asking = true;
  phase = why;
  asked = where;
  ++queries;
}

precise dvec3 ball_centre() {
  precise dvec3 centre = ball_foot + radius * ball_normal;
  return centre;
}

void begin_ray(dvec3 foot, dvec3 normal, double distance, uint face) {
  ball_foot = foot;
  ball_normal = normal;
  ball_distance = distance;
  precise double left = push.time - t;
  precise double most_radius = distance + left;
  limit = most_radius;
  radius = most_radius;
  ball_face = face;
  hit = face;
  touched = foot;
  ball_rounds = 0;
  ask(FLOW_RAY, ball_centre());
}

void record() {
  marks |= FLOW_RECORDED;
  recorded = t;
}

// A step off two contacts of a face each is under way.
bool on_sheet() {
  return count == 2 && single_faces() && (look_for == for_line || look_for == for_stage || look_for == for_balance || look_for == for_tie || look_for == for_gap);
}

double load(uint number) { return numbers[number * push.capacity + place]; }
dvec3 load3(uint number) { return dvec3(load(number), load(number + 1), load(number + 2)); }
uint load_word(uint word) { return words[word * push.capacity + place]; }
void save(uint number, double value) { numbers[number * push.capacity + place] = value; }
void save3(uint number, dvec3 value) {
  save(number, value.x);
  save(number + 1, value.y);
  save(number + 2, value.z);
}
void save_word(uint word, uint value) { words[word * push.capacity + place] = value; }

void load_state() {
  x = load3(0);
  t = load(3);
  carried = load(4);
  slide_time = load(5);
  slide_place = load3(6);
  ball_foot = load3(9);
  ball_normal = load3(12);
  touched = load3(15);
  ball_distance = load(18);
  radius = load(19);
  limit = load(20);
  k1 = load3(21);
  from_distance = load(24);
  step_length = load(25);
  next_step = load(26);
  slide_end = load3(27);
  const uint word = load_word(0);
  phase = word & 15;
  look_for = word >> 4 & 15;
  line = (word >> 8 & 1) != 0;
  in_tie = (word >> 9 & 1) != 0;
  side = int(word >> 10 & 3) - 1;
  stage = word >> 12 & 15;
  tries = word >> 16 & 63;
  round_of_balance = word >> 22 & 3;
  round_of_tie = word >> 24 & 63;
  const uint more = load_word(1);
  flags = more & 255;
  marks = more >> 8 & 255;
  count = more >> 16 & 15;
  ties = more >> 20 & 15;
  idle = more >> 24;
  counts = load_word(2);
  rounds = load_word(3);
  queries = load_word(4);
  events = load_word(5);
  steps = load_word(6);
  ball_face = load_word(7);
  hit = load_word(8);
  ball_rounds = load_word(9);
  nearer = load_word(10);
  extra = load_word(11);
  uint c = 0, k = 0;
  while (c < count) {
    faces[FLOW_CONTACT_FACES * c + k] = load_word(FLOW_STATE_FACES + FLOW_CONTACT_FACES * c + k);
    if (++k == faces_of(c)) {
      ++c;
      k = 0;
    }
  }
  if (c < count) ++planned; // cut short
}

void load_turn() {
  at = load3(30);
  k2 = load3(33);
  k3 = load3(36);
  k4 = load3(39);
  k5 = load3(42);
  k6 = load3(45);
  most = load(48);
  tried = load(49);
  low = load(50);
  high = load(51);
  low_gap = load(52);
  high_gap = load(53);
}

void save_state(bool busy) {
  save3(0, x);
  save(3, t);
  save(4, carried);
  save(5, slide_time);
  save3(6, slide_place);
  if (busy || phase != FLOW_SLIDE) {
    save3(9, ball_foot);
    save3(12, ball_normal);
    save3(15, touched);
    save(18, ball_distance);
    save(19, radius);
    save(20, limit);
  }
  if (busy || phase == FLOW_SLIDE) {
    save3(21, k1);
    save(24, from_distance);
    save(25, step_length);
    save(26, next_step);
    save3(27, slide_end);
  }
  save_word(0, phase | look_for << 4 | uint(line) << 8 | uint(in_tie) << 9 | uint(side + 1) << 10 | stage << 12 |
                   tries << 16 | round_of_balance << 22 | round_of_tie << 24);
  save_word(1, flags | (marks & 255) << 8 | count << 16 | ties << 20 | idle << 24);
  save_word(2, counts);
  save_word(3, rounds);
  save_word(4, queries);
  save_word(5, events);
  save_word(6, steps);
  save_word(7, ball_face);
  save_word(8, hit);
  save_word(9, ball_rounds);
  save_word(10, nearer);
  save_word(11, extra);
  uint c = 0, k = 0;
  while (c < count) {
    save_word(FLOW_STATE_FACES + FLOW_CONTACT_FACES * c + k, faces[FLOW_CONTACT_FACES * c + k]);
    if (++k == faces_of(c)) {
      ++c;
      k = 0;
    }
  }
  if (c < count) ++planned; // cut short
  if (!busy) return;
  save3(30, at);
  save3(33, k2);
  save3(36, k3);
  save3(39, k4);
  save3(42, k5);
  save3(45, k6);
  save(48, most);
  save(49, tried);
  save(50, low);
  save(51, high);
  save(52, low_gap);
  save(53, high_gap);
}

dvec3 vector_of(double v[3]) { return dvec3(v[0], v[1], v[2]); }

void depart() {
  x = vector_of(points[place].place);
  t = points[place].time;
  carried = 0;
  ball_foot = vector_of(points[place].foot);
  ball_normal = vector_of(points[place].normal);
  touched = ball_foot;
  ball_distance = points[place].distance;
  radius = points[place].radius;
  limit = radius;
  phase = points[place].phase;
  ball_face = points[place].face;
  hit = ball_face;
  ball_rounds = 0;
  flags = points[place].flags;
  marks = points[place].marks;
  rounds = points[place].rounds;
  queries = points[place].queries;
  events = points[place].events;
  steps = points[place].steps;
  idle = 0;
  count = 0;
  counts = 0;
}

void main() {
  if (gl_GlobalInvocationID.x >= push.entries) return;
  const FlowEntry entry = entries[push.first + gl_GlobalInvocationID.x];
  place = entry.place;
  planned = 0;
  done = 0;
  asked = vector_of(points[place].query);

  uint status = FLOW_ASKS, face = entry.face;
  if (face == FLOW_NO_FACE && entry.what != FLOW_RESUME) face = nearest(entry.query, asked, status);
  if (status == FLOW_ASKS && entry.what == FLOW_FIND) status = FLOW_FOUND;
  if (done != planned) status = FLOW_CUT;
  if (status != FLOW_ASKS) {
    points[place].status = status;
    if (status == FLOW_FOUND) points[place].face = face;
    return;
  }

  x = k1 = k2 = k3 = k4 = k5 = k6 = slide_end = slide_place = dvec3(0);
  from_distance = step_length = next_step = most = tried = low = high = low_gap = high_gap = slide_time = 0;
  nearer = FLOW_NO_FACE;
  ties = stage = tries = round_of_tie = round_of_balance = 0;
  side = 0;
  line = in_tie = false;
  if (entry.what == FLOW_DEPART)
    depart();
  else
    load_state();
  marks &= FLOW_INSIDE | FLOW_TIGHTER;
  if (entry.what == FLOW_RESUME) {
    load_turn();
  } else {
    extra = face;
    at = asked;
    look_for = phase == FLOW_LIFT ? for_lift : phase == FLOW_RAY ? for_ray : phase == FLOW_RESTART ? for_restart :
               phase == FLOW_SLIDE ? for_check : for_last;
  }
  const bool tighter = (marks & FLOW_TIGHTER) != 0;
  precise double tolerance = tighter ? push.tolerance[1] : push.tolerance[0];
  precise double longest = tighter ? push.longest[1] : push.longest[0];
  precise double most_rounds = tighter ? push.rounds[1] : push.rounds[0];

  if (sheet) {
    frame_0 = fetch_frame(faces[0]);
    frame_1 = fetch_frame(faces[FLOW_CONTACT_FACES]);
    const uint third = entry.what == FLOW_RESUME ? nearer : face;
    frame_extra = fetch_frame(third == FLOW_NO_FACE ? faces[0] : third);
  }

  asking = false;
  bool ended = false, elsewhere = false;
  uint turns = 0;
  do {
    const uint looked_for = look_for;
    if (sheet)
      look_on_sheet();
    else
      look(looked_for >= for_check);
    bool go_on = false, viewed = false, slide_ended = false, slide_over = false, settled = looked_for == for_velocity;
    bool seek = false, step_on = false;

    if (!sheet && looked_for == for_last) ended = true;
    if (!sheet && looked_for == for_restart) {
      count = 0;
      add_contact(extra);
      idle = 0;
      carried = 0;
      go_on = true;
    }
    if (!sheet && looked_for == for_lift) {
      precise double enough = radius - small(rounding, radius);
      if (extra_distance >= enough) {
        begin_ray(ball_foot, ball_normal, 0, ball_face);
      } else {
        flags |= notch_flag;
        precise double left = push.time - t, away = least(off_surface * push.scale, left);
        x = ball_foot + away * ball_normal;
        t = t + away;
        record();
        ask(FLOW_RESTART, x);
      }
    }
    if (!sheet && looked_for == for_ray) {
      precise double inner = radius - small(rounding, radius);
      precise dvec3 way = extra_point - ball_foot;
      precise double height = dot3(way, ball_normal), smaller = dot3(way, way) / (2 * height);
      precise double reach = norm3(extra_point - ball_centre());
      const bool shrinks = !(reach >= inner) && height > 0 && smaller < radius;
      if (shrinks) {
        radius = smaller;
        ++ball_rounds;
      }
      if (shrinks && ball_rounds < 100) {
        touched = extra_point;
        hit = extra;
        ask(FLOW_RAY, ball_centre());
      } else {
        radius = most_of(ball_distance, radius);
        x = ball_centre();
        precise double gone = radius - ball_distance;
        t = t + gone;
        record();
        go_on = true;
        if (radius >= limit) {
          t = push.time;
        } else {
          precise double stays = ball_distance + rounding * push.scale, join = same_point * radius;
          const bool moved = radius > stays;
          precise double apart_by = norm3(touched - ball_foot);
          const bool other = moved && apart_by < join;
          ++events;
          count = 0;
          add_contact(other ? hit : ball_face);
          if (!other && hit != ball_face) add_contact(hit);
          carried = 0;
          idle = moved ? 0 : idle + 1;
        }
      }
    }

    if (looked_for == for_stage) {
      k2 = stage == 2 ? velocity : k2;
      k3 = stage == 3 ? velocity : k3;
      k4 = stage == 4 ? velocity : k4;
      k5 = stage == 5 ? velocity : k5;
      k6 = stage == 6 ? velocity : k6;
      step_on = stage < 7;
      if (stage == 7) {
        precise dvec3 sum = 71.0lf / 57600 * k1 - 71.0lf / 16695 * k3 + 71.0lf / 1920 * k4 - 17253.0lf / 339200 * k5 +
                            22.0lf / 525 * k6 - 1.0lf / 40 * velocity;
        precise double error = norm3(step_length * sum);
        precise double allowed = tolerance * step_length + small(rounding, from_distance), least_step = apart * most;
        if (error <= allowed || step_length < least_step || tries == 30) {
          precise double more = error + 1e-30lf;
          next_step = step_length * least(4.0lf, longer(allowed, more));
          slide_end = at;
          look_for = for_balance;
          round_of_balance = 0;
        } else {
          step_length = step_length * most_of(0.1lf, longer(allowed, error));
          ++tries;
          tried = step_length;
          stage = 1;
          step_on = true;
        }
      }
    }

    if (look_for == for_balance) {
      precise dvec3 n0 = dvec3(0), n1 = n0, n2 = n0;
      precise double d0 = 0, d1 = 0, d2 = 0;
      uint m = 0;
      if (sheet) {
        n0 = normal_0;
        n1 = normal_1;
        d0 = distance_0;
        d1 = distance_1;
        m = 2;
      }
      const uint all = sheet ? 0 : count;
      planned += all;
      if (!sheet) for (uint c = 0; c < all; ++c) {
        ++done;
        if (!(weights[c] > 1e-9lf)) continue;
        if (m == 0) n0 = normal_of(c), d0 = distances[c];
        if (m == 1) n1 = normal_of(c), d1 = distances[c];
        if (m == 2) n2 = normal_of(c), d2 = distances[c];
        ++m;
      }
      precise dvec3 a = n1 - n0, b = n2 - n0;
      precise double ra = d0 - d1, rb = d0 - d2, aa = dot3(a, a), bb = dot3(b, b), ab = dot3(a, b);
      precise double determinant = aa * bb - ab * ab, thin = 1e-14lf * aa * bb;
      const bool pair = sheet || m == 2;
      const bool moves = m >= 2 && aa > 1e-16lf && (pair || determinant > thin);
      precise double alone = ra / aa, both_a = (ra * bb - rb * ab) / determinant;
      precise double both_b = (rb * aa - ra * ab) / determinant;
      precise dvec3 by_one = alone * a, by_two = both_a * a + both_b * b;
      precise double left = abs(ra) + (pair ? 0.0lf : abs(rb)), nothing = 1e-15lf * push.scale;
      if (moves) at = at + (pair ? by_one : by_two);
      ++round_of_balance;
      if (!moves || left < nothing || round_of_balance == 3) {
        if (in_tie) {
          look_for = for_gap;
          extra = nearer;
        } else {
          slide_end = at;
          ask(FLOW_SLIDE, slide_end);
        }
      }
    }

    if (looked_for == for_check) {
      precise double gap = extra_distance - view_distance, nearly = small(tie, view_distance);
      if (gap < -nearly) {
        nearer = extra;
        high = step_length;
        high_gap = gap;
        look_for = for_tie;
        at = x;
      } else {
        slide_ended = true;
        viewed = nearer == FLOW_NO_FACE;
      }
    }
    if (looked_for == for_tie) {
      low = 0;
      low_gap = extra_distance - active_distance();
      precise double nothing = 10 * small(rounding, from_distance);
      if (low_gap <= nothing) {
        slide_end = x;
        step_length = 0;
        slide_ended = true;
      } else {
        round_of_tie = 0;
        side = 0;
        seek = true;
      }
    }
    bool enough = false;
    if (looked_for == for_gap) {
      precise double here = extra_distance - active_distance(), nothing = small(rounding, from_distance) / 10;
      enough = abs(here) < nothing;
      if (here > 0) {
        low = tried;
        low_gap = here;
        if (side == 1) high_gap = high_gap / 2;
        side = 1;
      } else {
        high_gap = here;
        if (side == -1) low_gap = low_gap / 2;
        side = -1;
      }
      if (!(here > 0) || enough) {
        high = tried;
        slide_end = at;
      }
      seek = true;
    }
    if (seek) {
      precise double width = high - low, narrow = 1e-9lf * step_length;
      if (round_of_tie < 60 && width > narrow && !enough) {
        precise double middle = (low + high) / 2, secant = low + width * low_gap / (low_gap - high_gap);
        precise double s = round_of_tie % 4 == 3 ? middle : secant;
        if (!(s > low && s < high)) s = middle;
        ++round_of_tie;
        tried = s;
        in_tie = true;
        if (line) {
          precise dvec3 to = x + s * k1;
          at = to;
          extra = nearer;
          look_for = for_gap;
        } else {
          stage = 1;
          step_on = true;
        }
      } else {
        step_length = high;
        in_tie = false;
        if (step_length > 0 && ++ties < 12)
          ask(FLOW_SLIDE, slide_end);
        else
          slide_ended = true;
      }
    }
    if (slide_ended) {
      slide_over = nearer == FLOW_NO_FACE;
      look_for = for_nearer;
      at = slide_end;
      extra = nearer;
    }
    if (!sheet && looked_for == for_nearer) {
      precise double join = same_point * view_distance;
      ++events;
      uint c = 0;
      bool apart_from = c < count;
      while (apart_from) {
        precise double between = norm3(point_of(c) - extra_point);
        apart_from = !(between < join);
        if (apart_from) apart_from = ++c < count;
      }
      if (apart_from) ++planned; // cut short
      if (c < count)
        add_face(c, extra);
      else
        add_contact(extra);
      slide_over = true;
    }
    if (slide_over) {
      x = slide_end;
      t = t + step_length;
      record();
      precise double nowhere = apart * from_distance, quarter = next_step / 4, first = same_point * from_distance;
      idle = step_length < nowhere ? idle + 1 : 0;
      carried = nearer != FLOW_NO_FACE ? most_of(quarter, first) : next_step;
      go_on = true;
    }

    bool tidied = false;
    if (go_on) {
      const bool reached = t >= push.time_reached;
      const bool tired = !reached && double(rounds) >= most_rounds;
      if (!reached) ++rounds;
      if (tired) flags |= unfinished_flag;
      if (reached || tired) {
        ask(FLOW_LAST, x);
      } else if (idle > 6) {
        ask(FLOW_RESTART, x);
      } else {
        look_for = for_contacts;
        at = x;
        extra = FLOW_NO_FACE;
        tidied = viewed;
      }
    }
    if (tidied || looked_for == for_contacts) {
      const bool changed = tidy();
      elsewhere = sheet && changed;
      look_for = elsewhere ? for_contacts : for_velocity;
      at = x;
      extra = FLOW_NO_FACE;
      settled = !changed;
    }
    if (settled) {
      if (dot3(velocity, velocity) < 1e-16lf) {
        flags |= stationary_flag;
        ask(FLOW_LAST, x);
      } else if (!sheet && count == 1) {
        begin_ray(point_of(0), normal_of(0), view_distance, nearest_face);
      } else {
        if ((flags & slid_flag) == 0) {
          flags |= slid_flag;
          slide_time = t;
          slide_place = x;
        }
        k1 = velocity;
        from_distance = view_distance;
        precise double left = push.time - t, far = longest * view_distance / norm3(velocity);
        most = least(left, far);
        ++steps;
        nearer = FLOW_NO_FACE;
        ties = 0;
        in_tie = false;
        line = false;
        tries = 0;
        precise dvec3 to = x + most * k1;
        precise double tenth = most / 10;
        step_length = least(most, carried > 0 ? carried : tenth);
        tried = step_length;
        stage = 1;
        if (all_inside && single_faces()) {
          at = to;
          look_for = for_line;
        } else {
          step_on = true;
        }
      }
    }
    if (looked_for == for_line) {
      if (all_inside) {
        line = true;
        step_length = most;
        next_step = 0;
        slide_end = at;
        ask(FLOW_SLIDE, slide_end);
      } else {
        step_on = true;
      }
    }
    if (step_on) {
      precise dvec3 to = x + tried * slope();
      at = to;
      extra = FLOW_NO_FACE;
      ++stage;
      look_for = stage == 7 && in_tie ? for_balance : for_stage;
      round_of_balance = 0;
    }
    // Each kernel leaves to the other what that does better, or at all.
    if (sheet)
      elsewhere = elsewhere || look_for == for_nearer;
    else
      elsewhere = on_sheet();
    ++turns;
  } while (!asking && !ended && !elsewhere && turns < push.turns);

  const bool busy = !asking && !ended;
  if ((marks & FLOW_RECORDED) != 0) {
    points[place].place[0] = x.x;
    points[place].place[1] = x.y;
    points[place].place[2] = x.z;
    points[place].time = recorded;
  }
  if (ended) {
    points[place].place[0] = x.x;
    points[place].place[1] = x.y;
    points[place].place[2] = x.z;
    points[place].distance = (marks & FLOW_INSIDE) != 0 ? -extra_distance : extra_distance;
    points[place].face = extra;
    points[place].radius = slide_time;
    points[place].foot[0] = slide_place.x;
    points[place].foot[1] = slide_place.y;
    points[place].foot[2] = slide_place.z;
    points[place].flags = flags;
    points[place].queries = queries;
    points[place].events = events;
    points[place].steps = steps;
  } else {
    save_state(busy);
  }
  if (asking) {
    points[place].query[0] = asked.x;
    points[place].query[1] = asked.y;
    points[place].query[2] = asked.z;
    points[place].phase = phase;
  }
  if (asking ? phase == FLOW_SLIDE && count == 2 && single_faces() : !ended && (sheet ? !elsewhere : on_sheet()))
    marks |= FLOW_ON_SHEET;
  points[place].marks = marks;
  status = ended ? FLOW_DONE : asking ? FLOW_ASKS : FLOW_BUSY;
  if (done != planned || (busy && turns < push.turns && !elsewhere)) status = FLOW_CUT;
  points[place].status = status;
}
