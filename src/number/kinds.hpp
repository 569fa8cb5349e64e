// All number types, one line each. The generic number test runs over all of them.
#pragma once

#include "number/archetype.hpp"
#include "number/ball.hpp"
#include "number/bounded.hpp"
#include "number/counted.hpp"
#include "number/dual.hpp"
#include "number/interval.hpp"
#include "number/pack.hpp"
#include "number/real.hpp"
#include "number/recorded.hpp"
#include "number/rounded.hpp"

namespace lostbits {

template <class... T>
struct TypeList {};

using RunnableNumbers = TypeList<  //
    float,                         // what does the machine return?
    double,                        //
    Rounded<2>,                    // how many bits would be enough?
    Rounded<5>,                    //
    BFloat16,                      //
    Half,                          //
    TensorFloat32,                 //
    Rounded<24, -126, 127>,        //
    Rounded<26>,                   //
    Rounded<27>,                   //
    Rounded<52>,                   //
    Rounded<53>,                   //
    RoundedAny,                    //
    Ball,                          // what is certainly true, cheaply?
    Interval,                      // what is certainly true, at any precision?
    Real,                          // what does the formula give with no rounding?
    Dual<double, 2>,               // how sensitive is the problem itself?
    Pack<float, Registers<16>>,    // what does it cost in bulk?
    Pack<double, Registers<16>>,   //
    Counted<float>,                // what does it cost in operations?
    Counted<double>,               //
    Recorded,                      // which operation lost the bits?
    RecordedInDouble,              //
    Bounded<float>,                // what error bound does the formula itself prove?
    Bounded<double>                //
    >;

}  // namespace lostbits
