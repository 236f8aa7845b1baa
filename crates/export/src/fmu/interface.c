/* FMI 3.0: model exchange and co-simulation of the model in model.h. The types are those of the standard's headers. */
#include "model.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#if defined _WIN32
#define FMI3 __declspec(dllexport)
#else
#define FMI3 __attribute__((visibility("default")))
#endif

typedef void *fmi3Instance;
typedef void *fmi3InstanceEnvironment;
typedef void *fmi3FMUState;
typedef uint32_t fmi3ValueReference;
typedef const char *fmi3String;
typedef bool fmi3Boolean;
typedef bool fmi3Clock;
typedef const uint8_t *fmi3Binary;
typedef enum { fmi3OK, fmi3Warning, fmi3Discard, fmi3Error, fmi3Fatal } fmi3Status;
typedef int fmi3DependencyKind;
typedef int fmi3IntervalQualifier;
typedef void (*fmi3LogMessageCallback)(fmi3InstanceEnvironment, fmi3Status, fmi3String, fmi3String);
typedef void (*fmi3IntermediateUpdateCallback)(fmi3InstanceEnvironment, double, bool, bool, bool, bool, bool, bool *, double *);
typedef void (*fmi3ClockUpdateCallback)(fmi3InstanceEnvironment);
typedef void (*fmi3LockPreemptionCallback)(void);

static fmi3Status status_of(int ok)
{
    return ok ? fmi3OK : fmi3Error;
}

FMI3 const char *fmi3GetVersion(void)
{
    return "3.0";
}

FMI3 fmi3Status fmi3SetDebugLogging(fmi3Instance c, fmi3Boolean on, size_t n, const fmi3String categories[])
{
    (void)c; (void)on; (void)n; (void)categories;
    return fmi3OK;
}

static fmi3Instance instantiate(fmi3String token)
{
    model *m;
    if (token == NULL || strcmp(token, MODEL_TOKEN) != 0) {
        return NULL;
    }
    m = (model *)calloc(1, sizeof *m);
    if (m != NULL) {
        model_reset(m);
    }
    return m;
}

FMI3 fmi3Instance fmi3InstantiateModelExchange(fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible,
                                               fmi3Boolean logging, fmi3InstanceEnvironment environment,
                                               fmi3LogMessageCallback log)
{
    (void)name; (void)resources; (void)visible; (void)logging; (void)environment; (void)log;
    return instantiate(token);
}

FMI3 fmi3Instance fmi3InstantiateCoSimulation(fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible,
                                              fmi3Boolean logging, fmi3Boolean event_mode, fmi3Boolean early_return,
                                              const fmi3ValueReference intermediate[], size_t n,
                                              fmi3InstanceEnvironment environment, fmi3LogMessageCallback log,
                                              fmi3IntermediateUpdateCallback update)
{
    (void)name; (void)resources; (void)visible; (void)logging; (void)event_mode; (void)early_return; (void)intermediate;
    (void)n; (void)environment; (void)log; (void)update;
    return instantiate(token);
}

FMI3 fmi3Instance fmi3InstantiateScheduledExecution(fmi3String name, fmi3String token, fmi3String resources,
                                                    fmi3Boolean visible, fmi3Boolean logging,
                                                    fmi3InstanceEnvironment environment, fmi3LogMessageCallback log,
                                                    fmi3ClockUpdateCallback clock, fmi3LockPreemptionCallback lock,
                                                    fmi3LockPreemptionCallback unlock)
{
    (void)name; (void)token; (void)resources; (void)visible; (void)logging; (void)environment; (void)log; (void)clock;
    (void)lock; (void)unlock;
    return NULL;
}

FMI3 void fmi3FreeInstance(fmi3Instance c)
{
    free(c);
}

FMI3 fmi3Status fmi3EnterInitializationMode(fmi3Instance c, fmi3Boolean has_tolerance, double tolerance, double start,
                                            fmi3Boolean has_stop, double stop)
{
    (void)has_tolerance; (void)tolerance; (void)has_stop; (void)stop;
    ((model *)c)->time = start;
    return fmi3OK;
}

FMI3 fmi3Status fmi3ExitInitializationMode(fmi3Instance c)
{
    model_count_periods((model *)c);
    return fmi3OK;
}

#define NOTHING(name) \
    FMI3 fmi3Status name(fmi3Instance c) \
    { \
        (void)c; \
        return fmi3OK; \
    }
NOTHING(fmi3EnterEventMode)
NOTHING(fmi3Terminate)
NOTHING(fmi3EnterConfigurationMode)
NOTHING(fmi3ExitConfigurationMode)
NOTHING(fmi3EvaluateDiscreteStates)
NOTHING(fmi3EnterContinuousTimeMode)
NOTHING(fmi3EnterStepMode)

FMI3 fmi3Status fmi3Reset(fmi3Instance c)
{
    model_reset((model *)c);
    return fmi3OK;
}

FMI3 fmi3Status fmi3GetFloat64(fmi3Instance c, const fmi3ValueReference vr[], size_t n, double values[], size_t nv)
{
    size_t i;
    if (n != nv) {
        return fmi3Error;
    }
    for (i = 0; i < n; i++) {
        if (!model_get((model *)c, vr[i], &values[i])) {
            return fmi3Error;
        }
    }
    return fmi3OK;
}

FMI3 fmi3Status fmi3SetFloat64(fmi3Instance c, const fmi3ValueReference vr[], size_t n, const double values[], size_t nv)
{
    size_t i;
    if (n != nv) {
        return fmi3Error;
    }
    for (i = 0; i < n; i++) {
        if (!model_set((model *)c, vr[i], values[i])) {
            return fmi3Error;
        }
    }
    return fmi3OK;
}

FMI3 fmi3Status fmi3GetInt32(fmi3Instance c, const fmi3ValueReference vr[], size_t n, int32_t values[], size_t nv)
{
    size_t i;
    if (n != nv) {
        return fmi3Error;
    }
    for (i = 0; i < n; i++) {
        if (vr[i] != MODEL_PERIODS_REFERENCE) {
            return fmi3Error;
        }
        values[i] = ((model *)c)->periods;
    }
    return fmi3OK;
}

/* The model has no variables of these types. */
#define NO_VARIABLES(name, type) \
    FMI3 fmi3Status fmi3Get##name(fmi3Instance c, const fmi3ValueReference vr[], size_t n, type values[], size_t nv) \
    { \
        (void)c; (void)vr; (void)values; (void)nv; \
        return status_of(n == 0); \
    } \
    NO_INPUTS(name, type)
#define NO_INPUTS(name, type) \
    FMI3 fmi3Status fmi3Set##name(fmi3Instance c, const fmi3ValueReference vr[], size_t n, const type values[], size_t nv) \
    { \
        (void)c; (void)vr; (void)values; (void)nv; \
        return status_of(n == 0); \
    }
NO_VARIABLES(Float32, float)
NO_VARIABLES(Int8, int8_t)
NO_VARIABLES(UInt8, uint8_t)
NO_VARIABLES(Int16, int16_t)
NO_VARIABLES(UInt16, uint16_t)
NO_INPUTS(Int32, int32_t)
NO_VARIABLES(UInt32, uint32_t)
NO_VARIABLES(Int64, int64_t)
NO_VARIABLES(UInt64, uint64_t)
NO_VARIABLES(Boolean, bool)
NO_VARIABLES(String, fmi3String)

FMI3 fmi3Status fmi3GetBinary(fmi3Instance c, const fmi3ValueReference vr[], size_t n, size_t sizes[], fmi3Binary values[],
                              size_t nv)
{
    (void)c; (void)vr; (void)sizes; (void)values; (void)nv;
    return status_of(n == 0);
}

FMI3 fmi3Status fmi3SetBinary(fmi3Instance c, const fmi3ValueReference vr[], size_t n, const size_t sizes[],
                              const fmi3Binary values[], size_t nv)
{
    (void)c; (void)vr; (void)sizes; (void)values; (void)nv;
    return status_of(n == 0);
}

FMI3 fmi3Status fmi3GetClock(fmi3Instance c, const fmi3ValueReference vr[], size_t n, fmi3Clock values[])
{
    (void)c; (void)vr; (void)values;
    return status_of(n == 0);
}

FMI3 fmi3Status fmi3SetClock(fmi3Instance c, const fmi3ValueReference vr[], size_t n, const fmi3Clock values[])
{
    (void)c; (void)vr; (void)values;
    return status_of(n == 0);
}

FMI3 fmi3Status fmi3GetNumberOfVariableDependencies(fmi3Instance c, fmi3ValueReference vr, size_t *n)
{
    (void)c; (void)vr; (void)n;
    return fmi3Error;
}

FMI3 fmi3Status fmi3GetVariableDependencies(fmi3Instance c, fmi3ValueReference dependent, size_t element[],
                                            fmi3ValueReference independents[], size_t independent_element[],
                                            fmi3DependencyKind kinds[], size_t n)
{
    (void)c; (void)dependent; (void)element; (void)independents; (void)independent_element; (void)kinds; (void)n;
    return fmi3Error;
}

FMI3 fmi3Status fmi3GetFMUState(fmi3Instance c, fmi3FMUState *state)
{
    if (*state == NULL) {
        *state = malloc(sizeof(model));
    }
    if (*state == NULL) {
        return fmi3Error;
    }
    memcpy(*state, c, sizeof(model));
    return fmi3OK;
}

FMI3 fmi3Status fmi3SetFMUState(fmi3Instance c, fmi3FMUState state)
{
    memcpy(c, state, sizeof(model));
    return fmi3OK;
}

FMI3 fmi3Status fmi3FreeFMUState(fmi3Instance c, fmi3FMUState *state)
{
    (void)c;
    free(*state);
    *state = NULL;
    return fmi3OK;
}

FMI3 fmi3Status fmi3SerializedFMUStateSize(fmi3Instance c, fmi3FMUState state, size_t *size)
{
    (void)c; (void)state;
    *size = sizeof(model);
    return fmi3OK;
}

FMI3 fmi3Status fmi3SerializeFMUState(fmi3Instance c, fmi3FMUState state, uint8_t bytes[], size_t size)
{
    (void)c;
    if (size != sizeof(model)) {
        return fmi3Error;
    }
    memcpy(bytes, state, size);
    return fmi3OK;
}

FMI3 fmi3Status fmi3DeserializeFMUState(fmi3Instance c, const uint8_t bytes[], size_t size, fmi3FMUState *state)
{
    (void)c;
    if (size != sizeof(model)) {
        return fmi3Error;
    }
    if (*state == NULL) {
        *state = malloc(size);
    }
    if (*state == NULL) {
        return fmi3Error;
    }
    memcpy(*state, bytes, size);
    return fmi3OK;
}

FMI3 fmi3Status fmi3GetDirectionalDerivative(fmi3Instance c, const fmi3ValueReference unknowns[], size_t n,
                                             const fmi3ValueReference knowns[], size_t n_knowns, const double seed[],
                                             size_t n_seed, double sensitivity[], size_t n_sensitivity)
{
    if (n_knowns != n_seed || n != n_sensitivity) {
        return fmi3Error;
    }
    return status_of(model_directional((const model *)c, unknowns, n, knowns, n_knowns, seed, sensitivity));
}

FMI3 fmi3Status fmi3GetAdjointDerivative(fmi3Instance c, const fmi3ValueReference unknowns[], size_t n,
                                         const fmi3ValueReference knowns[], size_t n_knowns, const double seed[],
                                         size_t n_seed, double sensitivity[], size_t n_sensitivity)
{
    (void)c; (void)unknowns; (void)n; (void)knowns; (void)n_knowns; (void)seed; (void)n_seed; (void)sensitivity;
    (void)n_sensitivity;
    return fmi3Error;
}

FMI3 fmi3Status fmi3GetIntervalDecimal(fmi3Instance c, const fmi3ValueReference vr[], size_t n, double intervals[],
                                       fmi3IntervalQualifier qualifiers[])
{
    (void)c; (void)vr; (void)n; (void)intervals; (void)qualifiers;
    return fmi3Error;
}

FMI3 fmi3Status fmi3GetIntervalFraction(fmi3Instance c, const fmi3ValueReference vr[], size_t n, uint64_t counters[],
                                        uint64_t resolutions[], fmi3IntervalQualifier qualifiers[])
{
    (void)c; (void)vr; (void)n; (void)counters; (void)resolutions; (void)qualifiers;
    return fmi3Error;
}

FMI3 fmi3Status fmi3GetShiftDecimal(fmi3Instance c, const fmi3ValueReference vr[], size_t n, double shifts[])
{
    (void)c; (void)vr; (void)n; (void)shifts;
    return fmi3Error;
}

FMI3 fmi3Status fmi3GetShiftFraction(fmi3Instance c, const fmi3ValueReference vr[], size_t n, uint64_t counters[],
                                     uint64_t resolutions[])
{
    (void)c; (void)vr; (void)n; (void)counters; (void)resolutions;
    return fmi3Error;
}

FMI3 fmi3Status fmi3SetIntervalDecimal(fmi3Instance c, const fmi3ValueReference vr[], size_t n, const double intervals[])
{
    (void)c; (void)vr; (void)n; (void)intervals;
    return fmi3Error;
}

FMI3 fmi3Status fmi3SetIntervalFraction(fmi3Instance c, const fmi3ValueReference vr[], size_t n, const uint64_t counters[],
                                        const uint64_t resolutions[])
{
    (void)c; (void)vr; (void)n; (void)counters; (void)resolutions;
    return fmi3Error;
}

FMI3 fmi3Status fmi3SetShiftDecimal(fmi3Instance c, const fmi3ValueReference vr[], size_t n, const double shifts[])
{
    (void)c; (void)vr; (void)n; (void)shifts;
    return fmi3Error;
}

FMI3 fmi3Status fmi3SetShiftFraction(fmi3Instance c, const fmi3ValueReference vr[], size_t n, const uint64_t counters[],
                                     const uint64_t resolutions[])
{
    (void)c; (void)vr; (void)n; (void)counters; (void)resolutions;
    return fmi3Error;
}

FMI3 fmi3Status fmi3UpdateDiscreteStates(fmi3Instance c, fmi3Boolean *again, fmi3Boolean *terminate, fmi3Boolean *nominals,
                                         fmi3Boolean *values, fmi3Boolean *next_defined, double *next)
{
    model_count_periods((model *)c);
    *again = *terminate = *nominals = *values = *next_defined = false;
    *next = 0;
    return fmi3OK;
}

FMI3 fmi3Status fmi3CompletedIntegratorStep(fmi3Instance c, fmi3Boolean no_rollback, fmi3Boolean *enter_event_mode,
                                            fmi3Boolean *terminate)
{
    (void)c; (void)no_rollback;
    *enter_event_mode = *terminate = false;
    return fmi3OK;
}

FMI3 fmi3Status fmi3SetTime(fmi3Instance c, double time)
{
    ((model *)c)->time = time;
    return fmi3OK;
}

FMI3 fmi3Status fmi3SetContinuousStates(fmi3Instance c, const double x[], size_t n)
{
    if (n != MODEL_STATES) {
        return fmi3Error;
    }
    model_set_states((model *)c, x);
    return fmi3OK;
}

FMI3 fmi3Status fmi3GetContinuousStateDerivatives(fmi3Instance c, double rates[], size_t n)
{
    return status_of(n == MODEL_STATES && model_rates((const model *)c, rates));
}

FMI3 fmi3Status fmi3GetEventIndicators(fmi3Instance c, double indicators[], size_t n)
{
    if (n != MODEL_INDICATORS) {
        return fmi3Error;
    }
    model_indicators((const model *)c, indicators);
    return fmi3OK;
}

FMI3 fmi3Status fmi3GetContinuousStates(fmi3Instance c, double x[], size_t n)
{
    if (n != MODEL_STATES) {
        return fmi3Error;
    }
    model_states((const model *)c, x);
    return fmi3OK;
}

FMI3 fmi3Status fmi3GetNominalsOfContinuousStates(fmi3Instance c, double nominals[], size_t n)
{
    size_t i;
    (void)c;
    for (i = 0; i < n; i++) {
        nominals[i] = 1;
    }
    return status_of(n == MODEL_STATES);
}

FMI3 fmi3Status fmi3GetNumberOfEventIndicators(fmi3Instance c, size_t *n)
{
    (void)c;
    *n = MODEL_INDICATORS;
    return fmi3OK;
}

FMI3 fmi3Status fmi3GetNumberOfContinuousStates(fmi3Instance c, size_t *n)
{
    (void)c;
    *n = MODEL_STATES;
    return fmi3OK;
}

FMI3 fmi3Status fmi3GetOutputDerivatives(fmi3Instance c, const fmi3ValueReference vr[], size_t n, const int32_t orders[],
                                         double values[], size_t nv)
{
    (void)c; (void)vr; (void)n; (void)orders; (void)values; (void)nv;
    return fmi3Error;
}

FMI3 fmi3Status fmi3DoStep(fmi3Instance c, double time, double step, fmi3Boolean no_rollback, fmi3Boolean *event,
                           fmi3Boolean *terminate, fmi3Boolean *early_return, double *last)
{
    const int ok = model_advance((model *)c, time, step);
    (void)no_rollback;
    *event = *terminate = *early_return = false;
    *last = ((model *)c)->time;
    return status_of(ok);
}

FMI3 fmi3Status fmi3ActivateModelPartition(fmi3Instance c, fmi3ValueReference clock, double time)
{
    (void)c; (void)clock; (void)time;
    return fmi3Error;
}
