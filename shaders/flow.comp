// Advances every point by one event: from the answer to its query to its next query. The method, its names and its numbers
// are those of host/plan/flow_path.cpp; the same operations in the same order, all of them precise, give the same bits. The
// candidates are those of closest.comp; among them the nearest face is decided in double precision.
//
// Software devices run every branch under a mask, and what is called is inlined. So there is one loop with one place that
// looks at the contacts; what it looks for stands in `look_for`, and what follows from the view stands below in the order
// in which one thing may lead to the next. A point that is not through after push.turns goes on in the next dispatch.
//
// Most turns are those of steps off two contacts with a face each: sheets. For them there is a kernel of their own
// (FLOW_SHEET_ID) without the rest, with three frames fetched once; a point that is to do something else leaves it for the
// other kernel, which in turn does nothing that this one can.
//
// Software devices also end loops early without a word: every loop leaves a trace of having run to its end.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "shaders/closest.h"
#include "shaders/flow.h"

layout(local_size_x_id = COWGPU_LOCAL_SIZE_ID) in;
layout(constant_id = FLOW_SHEET_ID) const bool sheet = false;

#include "shaders/flow_state.glsl"
#include "shaders/flow_view.glsl"

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
