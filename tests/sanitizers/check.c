/* Calls every function of a module with arrays that end where its sizes end: for AddressSanitizer and UndefinedBehaviorSanitizer.
   What it prints are the sizes. */
#include "scene.h"

#include <stdio.h>
#include <stdlib.h>

static double *numbers(long count)
{
    double *all = malloc((size_t)count * sizeof *all);
    for (long i = 0; i < count; i++) {
        all[i] = 0.3 + 0.01 * (double)i;
    }
    return all;
}

int main(void)
{
    const long sizes[4] = {SCENE_BODIES, SCENE_CONFIGURATION, SCENE_FREEDOMS, SCENE_SPEEDS};
    for (int i = 0; i < 4; i++) {
        if (scene_sizes[i] != sizes[i]) {
            return 1;
        }
    }
    double *q = numbers(scene_sizes[1]), *tau = numbers(scene_sizes[2]), *v = numbers(scene_sizes[3]);
    double *rates = numbers(scene_forward_dynamics_results);
    double *rows = numbers(scene_forward_dynamics_derivatives_results);
    double *p = numbers(scene_momenta_results);
    double *back = numbers(scene_speeds_from_momenta_results);
    double *changes = numbers(scene_momentum_rates_results);
    double *energy = numbers(scene_hamiltonian_results);
    scene_forward_dynamics(q, v, tau, rates);
    scene_forward_dynamics_derivatives(q, v, tau, rows);
    scene_momenta(q, v, p);
    scene_speeds_from_momenta(q, p, back);
    scene_momentum_rates(q, p, tau, changes);
    scene_hamiltonian(q, p, energy);
    printf("%ld %ld %ld %ld %ld\n", sizes[0], sizes[1], sizes[2], sizes[3], scene_forward_dynamics_derivatives_results);
    double *all[] = {q, tau, v, rates, rows, p, back, changes, energy};
    for (int i = 0; i < 9; i++) {
        free(all[i]);
    }
    return 0;
}
