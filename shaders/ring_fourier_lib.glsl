// Small discrete Fourier transforms, y_k = sum_j x_j exp(-2 pi i j k / r), in place, real parts in `x`, imaginary in `y`.
const double HALF_ROOT = 0.70710678118654752440lf;
const double SIN_60 = 0.86602540378443864676lf;
const double COS_72 = 0.30901699437494742410lf, SIN_72 = 0.95105651629515357212lf;
const double COS_144 = -0.80901699437494742410lf, SIN_144 = 0.58778525229247312917lf;

dvec2 two_doubles(uvec4 texel) { return dvec2(packDouble2x32(texel.xy), packDouble2x32(texel.zw)); }

void dft_2(inout double x[8], inout double y[8]) {
  const double xr = x[0] - x[1], yr = y[0] - y[1];
  x[0] += x[1];
  y[0] += y[1];
  x[1] = xr;
  y[1] = yr;
}

void dft_3(inout double x[8], inout double y[8]) {
  const double xs = x[1] + x[2], ys = y[1] + y[2], xd = SIN_60 * (x[1] - x[2]), yd = SIN_60 * (y[1] - y[2]);
  const double xm = x[0] - 0.5lf * xs, ym = y[0] - 0.5lf * ys;
  x[0] += xs;
  y[0] += ys;
  x[1] = xm + yd;
  y[1] = ym - xd;
  x[2] = xm - yd;
  y[2] = ym + xd;
}

// Of elements a, b, c, d of the arrays.
void dft_4_of(inout double x[8], inout double y[8], const int a, const int b, const int c, const int d) {
  const double xs = x[a] + x[c], ys = y[a] + y[c], xd = x[a] - x[c], yd = y[a] - y[c];
  const double us = x[b] + x[d], vs = y[b] + y[d], ud = x[b] - x[d], vd = y[b] - y[d];
  x[a] = xs + us;
  y[a] = ys + vs;
  x[b] = xd + vd;
  y[b] = yd - ud;
  x[c] = xs - us;
  y[c] = ys - vs;
  x[d] = xd - vd;
  y[d] = yd + ud;
}

void dft_4(inout double x[8], inout double y[8]) { dft_4_of(x, y, 0, 1, 2, 3); }

void dft_5(inout double x[8], inout double y[8]) {
  const double xs = x[1] + x[4], ys = y[1] + y[4], xd = x[1] - x[4], yd = y[1] - y[4];
  const double us = x[2] + x[3], vs = y[2] + y[3], ud = x[2] - x[3], vd = y[2] - y[3];
  const double xa = x[0] + COS_72 * xs + COS_144 * us, ya = y[0] + COS_72 * ys + COS_144 * vs;
  const double xb = x[0] + COS_144 * xs + COS_72 * us, yb = y[0] + COS_144 * ys + COS_72 * vs;
  const double xe = SIN_72 * xd + SIN_144 * ud, ye = SIN_72 * yd + SIN_144 * vd;
  const double xf = SIN_144 * xd - SIN_72 * ud, yf = SIN_144 * yd - SIN_72 * vd;
  x[0] += xs + us;
  y[0] += ys + vs;
  x[1] = xa + ye;
  y[1] = ya - xe;
  x[4] = xa - ye;
  y[4] = ya + xe;
  x[2] = xb + yf;
  y[2] = yb - xf;
  x[3] = xb - yf;
  y[3] = yb + xf;
}

void dft_8(inout double x[8], inout double y[8]) {
  dft_4_of(x, y, 0, 2, 4, 6);
  dft_4_of(x, y, 1, 3, 5, 7);
  // The odd ones times exp(-2 pi i k / 8), k = 0 ... 3.
  const double x3 = HALF_ROOT * (x[3] + y[3]), y3 = HALF_ROOT * (y[3] - x[3]);
  const double x5 = y[5], y5 = -x[5];
  const double x7 = HALF_ROOT * (y[7] - x[7]), y7 = -HALF_ROOT * (x[7] + y[7]);
  const double xe[4] = double[4](x[0], x[2], x[4], x[6]), ye[4] = double[4](y[0], y[2], y[4], y[6]);
  const double xo[4] = double[4](x[1], x3, x5, x7), yo[4] = double[4](y[1], y3, y5, y7);
  [[unroll]] for (int k = 0; k < 4; ++k) {
    x[k] = xe[k] + xo[k];
    y[k] = ye[k] + yo[k];
    x[k + 4] = xe[k] - xo[k];
    y[k + 4] = ye[k] - yo[k];
  }
}
