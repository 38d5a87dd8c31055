!> What every rocking structure provides to the one integrator (rocking_response).
!>
!> The coordinate q >= 0 is the rotation away from rest in the direction `side` (+1 rocks to +x,
!> -1 to -x). All structures obey
!>
!>    M(q) q'' + (1/2) M'(q) q'^2 + V'(q) (1 + a_v/g) + side a_h H(q) = 0,
!>
!> with a_h, a_v the ground accelerations to +x and up (thesis Eqs 5.1, 5.2, 6.1).
module rocking_rocker
   use common_dense_step, only : dense_step
   use common_kinds, only : wp
   use common_status, only : status_ok
   use rocking_restraint, only : restraint_set
   use rocking_watch, only : joint_demand, joint_watch
   use, intrinsic :: iso_c_binding, only : c_int
   implicit none
   private
   public :: rocker, side_index, series_short

   !> A series whose error is below this share of the tolerance was cut short: a longer step is as cheap
   real(wp), parameter :: series_short = 1.0e-3_wp

   type, abstract :: rocker
      !> The second index of all pairs: 1 for side = +1, 2 for side = -1
      real(wp) :: restitution(2) = 1.0_wp  !! rate after over rate before an impact that starts this side
      real(wp) :: critical(2) = 0.0_wp     !! q of unstable equilibrium [rad]
      real(wp) :: limit(2) = 0.0_wp        !! q taken as collapse [rad]
      real(wp) :: rest_rate(2) = 0.0_wp    !! rate after impact below which the structure rests [rad/s]
      !> True where series_step solves the motion under straight-line accelerations
      logical :: has_series = .false.
      !> False where a wall keeps the structure from rocking to that side: it is thrown back from there
      logical :: free(2) = .true.
      real(wp) :: rebound(2) = 0.0_wp      !! rate after over rate before being thrown back to this side
      type(restraint_set), allocatable :: held  !! ties, springs and dampers, where there are any
      type(joint_watch), allocatable :: watch   !! what the joints must carry, where it is required
   contains
      procedure(coefficients), deferred :: coefficients
      procedure(potential), deferred :: potential
      procedure :: set_rest_rate
      procedure :: bound_joints
      procedure :: series_step
      procedure :: glide_samples
   end type rocker

   abstract interface
      pure subroutine coefficients(model, side, q, m, half_dm, dv, dh, closed)
         import :: rocker, wp
         implicit none (type, external)
         class(rocker), intent(in) :: model
         integer, intent(in) :: side       !! +1 or -1
         real(wp), intent(in) :: q         !! rotation [rad]
         real(wp), intent(out) :: m        !! M [kg m^2]
         real(wp), intent(out) :: half_dm  !! M'/2 [kg m^2]
         real(wp), intent(out) :: dv       !! V' [N m]
         real(wp), intent(out) :: dh       !! H [kg m]
         logical, intent(out) :: closed    !! false where the structure cannot take this q
      end subroutine coefficients

      pure function potential(model, side, q) result(v)
         import :: rocker, wp
         implicit none (type, external)
         class(rocker), intent(in) :: model
         integer, intent(in) :: side
         real(wp), intent(in) :: q
         real(wp) :: v  !! potential energy of gravity above rest [J]
      end function potential
   end interface

contains

   !> 1 for side +1, 2 for side -1
   pure function side_index(side) result(i)
      integer, intent(in) :: side
      integer :: i
      i = merge(1, 2, side > 0)
   end function side_index

   !> One step by the Taylor series of the solution while the ground acceleration is value + slope tau.
   !>
   !> A structure whose series is cheap overrides this and sets has_series; here nothing is known of one, so
   !> the step is refused.
   pure subroutine series_step(model, side, h, q, v, value, slope, tolerance, step)
      class(rocker), intent(in) :: model
      integer, intent(in) :: side            !! +1 or -1
      real(wp), intent(in) :: h              !! length [s]
      real(wp), intent(in) :: q              !! rotation at the start [rad]
      real(wp), intent(in) :: v              !! its rate [rad/s]
      real(wp), intent(in) :: value(2)       !! horizontal and vertical ground acceleration at the start [m/s^2]
      real(wp), intent(in) :: slope(2)       !! their change per second [m/s^3]
      real(wp), intent(in) :: tolerance(3)   !! absolute of q and of v, relative
      type(dense_step), intent(inout) :: step  !! t is left alone
      step%h = h
      step%error = huge(h)
      if (.false.) step%q = q + v + value(1) + slope(1) + tolerance(1) + model%critical(side_index(side))
   end subroutine series_step

   !> Whole segments of a sampled ground motion in which the structure neither turns nor touches the ground nor
   !> falls, each by one series; the state is that after the last of them. Here none: the general way takes them.
   pure subroutine glide_samples(model, side, start, spacing, scale, samples, first, last, tolerance, q, v, passed, &
                         step, stopped, demand)
      class(rocker), intent(in) :: model
      integer, intent(in) :: side            !! +1 or -1
      real(wp), intent(in) :: start          !! time of the first sample [s]
      real(wp), intent(in) :: spacing        !! of the samples [s]
      real(wp), intent(in) :: scale          !! factor on the samples
      real(wp), intent(in) :: samples(:, :)  !! (channels, points) [m/s^2]
      integer, intent(in) :: first           !! segment at whose start the state is given
      integer, intent(in) :: last            !! segment to go through at most
      real(wp), intent(in) :: tolerance(3)   !! absolute of q and of v, relative
      real(wp), intent(inout) :: q           !! rotation [rad]
      real(wp), intent(inout) :: v           !! its rate [rad/s]
      integer, intent(out) :: passed         !! segments
      type(dense_step), intent(inout) :: step  !! where it stopped: the segment in which something happens
      logical, intent(out) :: stopped        !! before the end of `last`
      type(joint_demand), intent(inout) :: demand  !! of a structure that is watched
      passed = 0
      stopped = .false.
      if (.false.) step%q = q + v + start + spacing + scale + samples(1, first) + samples(1, last) + tolerance(1) &
         + model%critical(side_index(side)) + demand%friction
   end subroutine glide_samples

   !> Rest where the kinetic energy after an impact is below 1e-6 of the energy barrier.
   !>
   !> Free rocking makes infinitely many impacts in finite time; for the slender block the rule
   !> is |theta'| < 1e-3 p alpha.
   pure subroutine set_rest_rate(model)
      class(rocker), intent(inout) :: model
      real(wp) :: m, half_dm, dv, dh
      logical :: closed
      integer :: i
      do i = 1, 2
         call model%coefficients(3 - 2 * i, 0.0_wp, m, half_dm, dv, dh, closed)
         model%rest_rate(i) = 1.0e-3_wp * sqrt(2.0_wp * max(model%potential(3 - 2 * i, model%critical(i)), 0.0_wp) / m)
      end do
   end subroutine set_rest_rate

   !> Bounds of what the joints demand, for many runs: up to the rate that crosses the energy barrier from rest, and to twice the
   !> ground acceleration that lifts the structure
   pure subroutine bound_joints(model, runs, status)
      class(rocker), intent(inout) :: model
      integer, intent(in) :: runs
      integer(c_int), intent(out) :: status
      real(wp) :: m, half_dm, dv, dh, drive(2)
      logical :: closed
      integer :: i
      status = status_ok
      if (.not. allocated(model%watch)) return
      do i = 1, 2
         call model%coefficients(3 - 2 * i, 0.0_wp, m, half_dm, dv, dh, closed)
         drive(i) = 2.0_wp * dv / dh
      end do
      call model%watch%bound_demand(runs, drive, (1.0e3_wp * model%rest_rate)**2, status)
   end subroutine bound_joints

end module rocking_rocker
