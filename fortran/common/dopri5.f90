!> Dormand-Prince 5(4) for one degree of freedom, q'' = f(t, q, q').
!>
!> Source: J. R. Dormand and P. J. Prince, J. Comput. Appl. Math. 6 (1980) 19-26; dense output and
!> PI step control after E. Hairer, S. P. Norsett and G. Wanner, Solving Ordinary Differential
!> Equations I, 2nd ed., II.5, II.6 and IV.2. The thesis integrates with the same pair (App. B.3).
module common_dopri5
   use common_dense_step, only : dense_step
   use common_kinds, only : wp
   implicit none
   private
   public :: oscillator, dopri5_attempt, dopri5_factor, step_memory

   !> A second-order equation of one degree of freedom
   type, abstract :: oscillator
   contains
      procedure(acceleration), deferred :: acceleration
   end type oscillator

   abstract interface
      !> q'' at the given state
      function acceleration(system, t, q, v) result(a)
         import :: oscillator, wp
         implicit none (type, external)
         class(oscillator), intent(in) :: system
         real(wp), intent(in) :: t  !! time [s]
         real(wp), intent(in) :: q  !! coordinate
         real(wp), intent(in) :: v  !! its rate
         real(wp) :: a
      end function acceleration
   end interface

   !> What the PI controller remembers between steps
   type :: step_memory
      real(wp) :: error_before = 1.0e-4_wp
      logical :: rejected = .false.
   end type step_memory

   real(wp), parameter :: c2 = 1.0_wp / 5.0_wp, c3 = 3.0_wp / 10.0_wp, c4 = 4.0_wp / 5.0_wp, c5 = 8.0_wp / 9.0_wp
   real(wp), parameter :: a21 = 1.0_wp / 5.0_wp
   real(wp), parameter :: a31 = 3.0_wp / 40.0_wp, a32 = 9.0_wp / 40.0_wp
   real(wp), parameter :: a41 = 44.0_wp / 45.0_wp, a42 = -56.0_wp / 15.0_wp, a43 = 32.0_wp / 9.0_wp
   real(wp), parameter :: a51 = 19372.0_wp / 6561.0_wp, a52 = -25360.0_wp / 2187.0_wp, &
      a53 = 64448.0_wp / 6561.0_wp, a54 = -212.0_wp / 729.0_wp
   real(wp), parameter :: a61 = 9017.0_wp / 3168.0_wp, a62 = -355.0_wp / 33.0_wp, &
      a63 = 46732.0_wp / 5247.0_wp, a64 = 49.0_wp / 176.0_wp, a65 = -5103.0_wp / 18656.0_wp
   real(wp), parameter :: b1 = 35.0_wp / 384.0_wp, b3 = 500.0_wp / 1113.0_wp, b4 = 125.0_wp / 192.0_wp, &
      b5 = -2187.0_wp / 6784.0_wp, b6 = 11.0_wp / 84.0_wp
   real(wp), parameter :: e1 = 71.0_wp / 57600.0_wp, e3 = -71.0_wp / 16695.0_wp, e4 = 71.0_wp / 1920.0_wp, &
      e5 = -17253.0_wp / 339200.0_wp, e6 = 22.0_wp / 525.0_wp, e7 = -1.0_wp / 40.0_wp
   real(wp), parameter :: d1 = -12715105075.0_wp / 11282082432.0_wp, d3 = 87487479700.0_wp / 32700410799.0_wp, &
      d4 = -10690763975.0_wp / 1880347072.0_wp, d5 = 701980252875.0_wp / 199316789632.0_wp, &
      d6 = -1453857185.0_wp / 822651844.0_wp, d7 = 69997945.0_wp / 29380423.0_wp

contains

   !> Take one step of length h from (t, q, v); the caller accepts it where error <= 1
   subroutine dopri5_attempt(problem, t, h, q, v, a, atol_q, atol_v, rtol, step)
      class(oscillator), intent(in) :: problem
      real(wp), intent(in) :: t                !! start time
      real(wp), intent(in) :: h                !! step length, > 0
      real(wp), intent(in) :: q                !! coordinate at t
      real(wp), intent(in) :: v                !! rate at t
      real(wp), intent(in) :: a                !! acceleration at t (first same as last)
      real(wp), intent(in) :: atol_q           !! absolute tolerance of q
      real(wp), intent(in) :: atol_v           !! absolute tolerance of v
      real(wp), intent(in) :: rtol             !! relative tolerance
      type(dense_step), intent(inout) :: step
      real(wp) :: v2, v3, v4, v5, v6, k2, k3, k4, k5, k6, q_new, v_new, k7, error_q, error_v

      v2 = v + h * a21 * a
      k2 = problem%acceleration(t + c2 * h, q + h * a21 * v, v2)
      v3 = v + h * (a31 * a + a32 * k2)
      k3 = problem%acceleration(t + c3 * h, q + h * (a31 * v + a32 * v2), v3)
      v4 = v + h * (a41 * a + a42 * k2 + a43 * k3)
      k4 = problem%acceleration(t + c4 * h, q + h * (a41 * v + a42 * v2 + a43 * v3), v4)
      v5 = v + h * (a51 * a + a52 * k2 + a53 * k3 + a54 * k4)
      k5 = problem%acceleration(t + c5 * h, q + h * (a51 * v + a52 * v2 + a53 * v3 + a54 * v4), v5)
      v6 = v + h * (a61 * a + a62 * k2 + a63 * k3 + a64 * k4 + a65 * k5)
      k6 = problem%acceleration(t + h, q + h * (a61 * v + a62 * v2 + a63 * v3 + a64 * v4 + a65 * v5), v6)
      q_new = q + h * (b1 * v + b3 * v3 + b4 * v4 + b5 * v5 + b6 * v6)
      v_new = v + h * (b1 * a + b3 * k3 + b4 * k4 + b5 * k5 + b6 * k6)
      k7 = problem%acceleration(t + h, q_new, v_new)

      error_q = h * (e1 * v + e3 * v3 + e4 * v4 + e5 * v5 + e6 * v6 + e7 * v_new)
      error_v = h * (e1 * a + e3 * k3 + e4 * k4 + e5 * k5 + e6 * k6 + e7 * k7)
      step%error = sqrt(0.5_wp * ((error_q / (atol_q + rtol * max(abs(q), abs(q_new))))**2 &
                                + (error_v / (atol_v + rtol * max(abs(v), abs(v_new))))**2))
      step%t = t
      step%h = h
      step%q = q_new
      step%v = v_new
      step%a = k7

      step%degree = 4
      call extension(q, q_new, h * v, h * v_new, h * (d1 * v + d3 * v3 + d4 * v4 + d5 * v5 + d6 * v6 + d7 * v_new), &
         step%cq(0:4))
      call extension(v, v_new, h * a, h * k7, h * (d1 * a + d3 * k3 + d4 * k4 + d5 * k5 + d6 * k6 + d7 * k7), &
         step%cv(0:4))
   end subroutine dopri5_attempt

   !> Factor for the next step length by the PI controller; remembers the error of accepted steps
   subroutine dopri5_factor(error, memory, factor)
      real(wp), intent(in) :: error                !! estimate over tolerance of the last attempt
      type(step_memory), intent(inout) :: memory
      real(wp), intent(out) :: factor              !! multiply the last step length by this
      real(wp), parameter :: beta = 0.04_wp, exponent = 0.2_wp - 0.75_wp * beta, safety = 0.9_wp
      real(wp) :: power

      if (.not. error <= huge(error)) then  ! NaN and infinity end here
         factor = 0.1_wp
         memory%rejected = .true.
         return
      end if
      power = max(error, 1.0e-12_wp)**exponent
      if (error <= 1.0_wp) then
         factor = safety * memory%error_before**beta / power
         factor = min(5.0_wp, max(0.2_wp, factor))
         if (memory%rejected) factor = min(1.0_wp, factor)
         memory%error_before = max(error, 1.0e-4_wp)
         memory%rejected = .false.
      else
         factor = max(0.1_wp, safety / power)
         memory%rejected = .true.
      end if
   end subroutine dopri5_factor

   !> The extension of order 4 by powers of the fraction s; Hairer's form is
   !> y0 + s (rise + (1 - s) (c3 + s (c4 + (1 - s) top)))
   pure subroutine extension(start, finish, slope_start, slope_finish, top, c)
      real(wp), intent(in) :: start         !! value at s = 0
      real(wp), intent(in) :: finish        !! value at s = 1
      real(wp), intent(in) :: slope_start   !! derivative to s at s = 0
      real(wp), intent(in) :: slope_finish  !! derivative to s at s = 1
      real(wp), intent(in) :: top           !! coefficient of s^4
      real(wp), intent(out) :: c(0:4)
      real(wp) :: rise, c3, c4
      rise = finish - start
      c3 = slope_start - rise
      c4 = rise - slope_finish - c3
      c = [start, slope_start, -c3 + c4 + top, -c4 - 2.0_wp * top, top]
   end subroutine extension

end module common_dopri5
