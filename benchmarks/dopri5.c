/* The limit of what one core can do: (13)-(14) on flat arrays with Dormand and Prince's method of order 5(4).
 * Compiled by benchmarks/c_limit.py, which checks its right-hand side against models/equations.py in every run. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct {
    long n, edges, tones;
    const long *tail, *head;
    const double *weight, *leader_weight, *m, *inertia, *offset_x, *offset_y, *p_v, *d_v, *p_omega, *d_omega, *k_alpha;
    const double *frequency, *sine, *cosine;
    double leader_x, leader_y, leader_theta;
} Loop;

/* (8), (10): e_i = a_il tanh(z_i - z_l) + sum_j a_ij tanh(z_i - z_j), where z = q - offset */
static void error(const Loop *p, const double *restrict q, const double *restrict offset, double leader,
                  double *restrict z, double *restrict f, double *restrict e)
{
    for (long i = 0; i < p->n; i++) z[i] = q[i] - (offset ? offset[i] : 0.0);
    for (long i = 0; i < p->n; i++) e[i] = p->leader_weight[i] * tanh(z[i] - leader);
    for (long k = 0; k < p->edges; k++) f[k] = z[p->tail[k]] - z[p->head[k]];
    for (long k = 0; k < p->edges; k++) f[k] = p->weight[k] * tanh(f[k]);
    for (long k = 0; k < p->edges; k++) { e[p->tail[k]] += f[k]; e[p->head[k]] -= f[k]; }
}

void rate(const Loop *p, double t, const double *restrict x, double *restrict out, double *restrict work)
{
    long n = p->n;
    const double *theta = x + 2 * n, *v = x + 3 * n, *omega = x + 4 * n;
    double *ex = work, *ey = ex + n, *et = ey + n, *z = et + n, *f = z + n, psi = 0.0;
    for (long k = 0; k < p->tones; k++)
        psi += p->sine[k] * sin(p->frequency[k] * t) + p->cosine[k] * cos(p->frequency[k] * t);
    error(p, x, p->offset_x, p->leader_x, z, f, ex);
    error(p, x + n, p->offset_y, p->leader_y, z, f, ey);
    error(p, theta, 0, p->leader_theta, z, f, et);
    for (long i = 0; i < n; i++) out[i] = cos(theta[i]);
    for (long i = 0; i < n; i++) out[n + i] = sin(theta[i]);
    for (long i = 0; i < n; i++) out[3 * n + i] = p->d_v[i] * tanh(v[i]);
    for (long i = 0; i < n; i++) out[4 * n + i] = p->d_omega[i] * tanh(omega[i]);
    for (long i = 0; i < n; i++) {
        double c = out[i], s = out[n + i], alpha = p->k_alpha[i] * psi * (c * ey[i] - s * ex[i]);
        out[3 * n + i] = (-p->p_v[i] * (c * ex[i] + s * ey[i]) - out[3 * n + i]) / p->m[i];
        out[4 * n + i] = (-p->p_omega[i] * et[i] - out[4 * n + i] + alpha) / p->inertia[i];
        out[i] = c * v[i];
        out[n + i] = s * v[i];
        out[2 * n + i] = omega[i];
    }
}

static const double A[6][6] = {
    {1 / 5.},
    {3 / 40., 9 / 40.},
    {44 / 45., -56 / 15., 32 / 9.},
    {19372 / 6561., -25360 / 2187., 64448 / 6561., -212 / 729.},
    {9017 / 3168., -355 / 33., 46732 / 5247., 49 / 176., -5103 / 18656.},
    {35 / 384., 0, 500 / 1113., 125 / 192., -2187 / 6784., 11 / 84.}};
static const double C[6] = {1 / 5., 3 / 10., 4 / 5., 8 / 9., 1, 1};
static const double E[7] = {71 / 57600., 0, -71 / 16695., 71 / 1920., -17253 / 339200., 22 / 525., -1 / 40.};

/* Integrates x from t to end in place; the number of steps, or -1 where the step vanishes. */
long integrate(const Loop *p, double t, double end, double *x, double tolerance)
{
    long size = 5 * p->n, steps = 0;
    double *k = malloc(sizeof(double) * 7 * size), *new = malloc(sizeof(double) * size), h = 1e-4;
    double *work = malloc(sizeof(double) * (4 * p->n + p->edges));
    rate(p, t, x, k, work);
    while (t < end) {
        if (t + 1.0001 * h >= end) h = end - t;
        for (int s = 0; s < 6; s++) {
            memcpy(new, x, sizeof(double) * size);
            for (int j = 0; j <= s; j++) {
                const double c = h * A[s][j], *restrict kj = k + j * size;
                if (c != 0) for (long i = 0; i < size; i++) new[i] += c * kj[i];
            }
            rate(p, t + C[s] * h, new, k + (s + 1) * size, work);
        }
        double sum = 0;
        for (long i = 0; i < size; i++) {
            double e = 0, scale = 1 + fmax(fabs(x[i]), fabs(new[i]));
            for (int j = 0; j < 7; j++) e += E[j] * k[j * size + i];
            e *= h / (tolerance * scale);
            sum += e * e;
        }
        double err = sqrt(sum / size);
        if (err <= 1) {
            t = h >= end - t ? end : t + h;
            memcpy(x, new, sizeof(double) * size);
            memcpy(k, k + 6 * size, sizeof(double) * size);
            steps++;
        }
        h *= err > 0 ? fmin(5, fmax(0.2, 0.9 * pow(err, -0.2))) : 5;
        if (!(h > 1e-12)) { steps = -1; break; }
    }
    free(k); free(new); free(work);
    return steps;
}
