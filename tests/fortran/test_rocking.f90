!> Rockers: potentials are the integrals of V'; free rocking of the slender block meets its closed form, impact by
!> impact.
program test_rocking
   use common_kinds, only : wp, gravity
   use common_lists, only : rocking_event_impact, rocking_outcome_recovery
   use common_signal, only : signal, signal_piecewise
   use common_status, only : status_ok, status_invalid_argument
   use rocking_arch_rocker, only : arch_rocker, arch_rocker_new
   use rocking_block_rocker, only : block_rocker, block_rocker_new
   use rocking_response, only : find_response, response, response_options, response_history
   use rocking_rocker, only : rocker
   use, intrinsic :: iso_c_binding, only : c_int
   implicit none (type, external)
   real(wp), parameter :: arch_values(21) = [-9.07_wp, 1.80_wp, -5.97_wp, 8.94_wp, 2.1_wp, 10.54_wp, 10.54_wp, &
      2.10_wp, 11.3_wp, 12.1_wp, 17.9_wp, -8.3_wp, 5.6_wp, -2.1_wp, 9.7_wp, 7.4_wp, 6.9_wp, 31.0_wp, 43.0_wp, &
      59.0_wp, 0.9_wp]
   real(wp), parameter :: block_values(9) = [0.0_wp, 1000.0_wp, 1500.0_wp, 2.0_wp, 0.5_wp, 0.4_wp, 0.9_wp, 0.8_wp, &
      0.0_wp]
   type(arch_rocker) :: arch
   type(block_rocker) :: stone
   integer(c_int) :: status

   call arch_rocker_new(arch_values, arch, status)
   if (status /= status_ok) error stop 'the arch is refused'
   call potential_is_integral(arch, 'arch')
   call block_rocker_new(block_values, stone, status)
   if (status /= status_ok) error stop 'the block is refused'
   call potential_is_integral(stone, 'block')
   call block_rocker_new([block_values(:8), 0.05_wp], stone, status)
   call potential_is_integral(stone, 'block on sloping ground')
   call block_rocker_new([1.0_wp, block_values(2:)], stone, status)
   call potential_is_integral(stone, 'slender block')
   call block_rocker_new([1.0_wp, block_values(2:6), 1.1_wp, 0.8_wp, 0.0_wp], stone, status)
   if (status /= status_invalid_argument) error stop 'a restitution above 1 is taken'
   call free_rocking()
   print '(a)', 'rocking: all right'

contains

   !> V(q) - V(0) = integral of V' by Simpson's rule, to both sides
   subroutine potential_is_integral(body, what)
      class(rocker), intent(in) :: body
      character(len=*), intent(in) :: what
      integer, parameter :: parts = 400
      integer :: side, k
      real(wp) :: q, total, m, half_dm, dv, dh
      logical :: closed
      do side = -1, 1, 2
         total = 0.0_wp
         q = body%critical(merge(1, 2, side > 0))
         do k = 0, parts
            call body%coefficients(side, q * k / parts, m, half_dm, dv, dh, closed)
            if (.not. closed) error stop 'a mechanism does not close'
            total = total + dv * merge(1.0_wp, merge(2.0_wp, 4.0_wp, mod(k, 2) == 0), k == 0 .or. k == parts)
         end do
         total = total * q / (3.0_wp * parts)
         if (.not. abs(body%potential(side, q) - total) < 1e-9_wp * abs(total)) error stop what
         if (abs(dv) > 1e-6_wp * m) error stop 'V'' does not vanish at the critical rotation'
      end do
   end subroutine potential_is_integral

   !> The slender block let go at q0 strikes after acosh(1 / (1 - q0 / alpha)) / p and rises to the other side so that
   !> 1 - q1/alpha = sqrt(1 - c^2 (1 - (1 - q0/alpha)^2)) (Housner 1963)
   subroutine free_rocking()
      integer, parameter :: room = 64
      real(wp), parameter :: alpha = atan2(0.5_wp, 2.0_wp), start = 0.6_wp, restitution = 0.85_wp
      real(wp), target :: time(1), state(8, 1), event(2, room)
      integer(c_int), target :: kinds(room)
      real(wp), target :: breaks(2), lines(2, 1, 1), sines(4, 0, 1, 1)
      real(wp) :: p, ratio, moment, quarter
      type(signal) :: still
      type(response) :: answer
      type(response_history) :: record
      integer :: k, impacts
      call block_rocker_new([1.0_wp, block_values(2:4), 0.5_wp, 0.5_wp, restitution, restitution, &
         0.0_wp], stone, status)
      breaks = [0.0_wp, 1.0_wp]
      lines = 0.0_wp
      still = signal_piecewise(breaks, lines, sines, 1.0_wp)
      time = 6.0_wp
      record%time => time
      record%state => state
      record%event => event
      record%event_kind => kinds
      call find_response(stone, still, response_options(end_time=6.0_wp, start_q=start * alpha), answer, status, record)
      if (status /= status_ok .or. answer%outcome /= rocking_outcome_recovery) error stop 'free rocking'
      ratio = start
      moment = 0.0_wp
      impacts = 0
      p = sqrt(1000.0_wp * hypot(0.5_wp, 2.0_wp) * gravity / (1500.0_wp + 1000.0_wp * (0.25_wp + 4.0_wp)))
      quarter = acosh(1.0_wp / (1.0_wp - ratio)) / p
      moment = quarter
      do k = 1, min(record%events, room)
         if (kinds(k) /= rocking_event_impact) cycle
         impacts = impacts + 1
         if (abs(event(1, k) - moment) > 1e-6_wp) error stop 'an impact is late or early'
         ratio = 1.0_wp - sqrt(1.0_wp - restitution**2 * (1.0_wp - (1.0_wp - ratio)**2))
         quarter = acosh(1.0_wp / (1.0_wp - ratio)) / p
         moment = moment + 2.0_wp * quarter
         if (impacts == 5) exit
      end do
      if (impacts < 5) error stop 'impacts are missed'
   end subroutine free_rocking

end program test_rocking
