/* A box test in C: the slabs, one after the other. */
#include <lostbits_plugin.h>

static const char *slabs(const lb_batch *batch) {
    const double *ray = batch->rays, *box = batch->primitives, *ends = batch->ends;
    double *near_far = batch->near_far;
    size_t i;
    for (i = 0; i < batch->size; ++i, ray += 6, box += batch->primitive_stride, near_far += 2) {
        double near = 0, far = ends ? ends[i] : 1e300;
        int k;
        for (k = 0; k < 3; ++k) {
            const double a = (box[k] - ray[k]) / ray[3 + k], b = (box[3 + k] - ray[k]) / ray[3 + k];
            const double first = a < b ? a : b, last = a < b ? b : a;
            if (first > near) near = first;
            if (last < far) far = last;
        }
        batch->hit[i] = near <= far;
        near_far[0] = near;
        near_far[1] = far;
    }
    return NULL;
}

const lb_form *lostbits_forms(int abi, size_t *count) {
    static const lb_form forms[] = {
        {"c.slabs", "slabs in C", NULL, LB_BOX, LB_F64, LB_ANY, LB_BOTH, LB_HIT, LB_HIT, 0, NULL, slabs}};
    *count = 1;
    return abi == LOSTBITS_PLUGIN_ABI ? forms : NULL;
}
