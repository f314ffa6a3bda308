// How the contacts of a point look from a place, for flow.comp: feet on triangles, directions, the least vector of a hull.

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

// The view.
double normal_x[FLOW_CONTACTS], normal_y[FLOW_CONTACTS], normal_z[FLOW_CONTACTS];
double point_x[FLOW_CONTACTS], point_y[FLOW_CONTACTS], point_z[FLOW_CONTACTS];
double distances[FLOW_CONTACTS], weights[FLOW_CONTACTS];
double feet[FLOW_CONTACTS * FLOW_CONTACT_FACES]; // distances of the contacts' faces
uint nearest_face;                                       // of the first contact
dvec3 velocity, extra_point;
double view_distance, extra_distance;
bool all_inside;

// The nearest of a query's candidates: closest_of of host/plan/closest_kernel.hpp.
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
