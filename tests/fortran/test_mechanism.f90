!> Mechanisms: the four-hinge equations through the general path, a lock in closed form, tables that keep energy,
!> and refusals.
program test_mechanism
   use common_kinds, only : wp, gravity
   use common_status, only : status_ok
   use arch_four_hinge, only : four_hinge, four_hinge_new
   use mechanism_impact, only : energy_product, projected_restitution
   use mechanism_linkage, only : linkage, linkage_new, linkage_state
   use mechanism_table, only : side_table, table_facts, table_new, table_numbers, table_pack, table_unpack
   use rocking_table_rocker, only : table_parameters, table_rocker, table_rocker_new
   use, intrinsic :: iso_c_binding, only : c_int
   implicit none (type, external)

   call arch()
   call lock()
   call block()
   call impact()
   print '(a)', 'ok'

contains

   !> A linkage A-B-C-D of three parts on the ground
   subroutine four_bar(hinge, mass, centroid, inertia, made, rest, status)
      real(wp), intent(in) :: hinge(2, 4), mass(3), centroid(2, 3), inertia(3)
      type(linkage), intent(out) :: made
      type(linkage_state), intent(out) :: rest
      integer(c_int), intent(out) :: status
      integer(c_int) :: row(2, 8), h
      do h = 1, 4
         row(:, 2 * h - 1) = [h, 1_c_int]
         row(:, 2 * h) = [h, 2_c_int]
      end do
      call linkage_new(mass, centroid, inertia, &
         reshape([1_c_int, 0_c_int, 2_c_int, 1_c_int, 3_c_int, 2_c_int, 3_c_int, 0_c_int], [2, 4]), hinge, row, &
         1_c_int, -1.0_wp, made, rest, status)
   end subroutine four_bar

   !> The linkage of Oppenheim's arch: kinematics and table against the closed form of the four-hinge mechanism
   subroutine arch()
      real(wp), parameter :: hinge(2, 4) = reshape([-9.07_wp, 1.80_wp, -5.97_wp, 8.94_wp, 2.1_wp, 10.54_wp, 10.54_wp, &
         2.10_wp], [2, 4])
      real(wp), parameter :: mass(3) = [11.3_wp, 12.1_wp, 17.9_wp], inertia(3) = [31.0_wp, 43.0_wp, 59.0_wp]
      real(wp), parameter :: centroid(2, 3) = reshape([-8.3_wp, 5.6_wp, -2.1_wp, 9.7_wp, 7.4_wp, 6.9_wp], [2, 3])
      type(four_hinge) :: reference
      type(linkage) :: made
      type(linkage_state) :: rest
      type(side_table) :: table, again
      type(table_facts) :: facts
      type(table_rocker) :: body
      real(wp), allocatable :: list(:), parameters(:)
      real(wp) :: q, found(4), wanted(4)
      integer(c_int) :: status
      integer :: k
      logical :: closed

      allocate (list(table_numbers), parameters(table_parameters))
      call four_hinge_new(hinge, mass, centroid, inertia, reference, status)
      call demand(status == status_ok, 'four hinges')
      call four_bar(hinge, mass, centroid, inertia, made, rest, status)
      call demand(status == status_ok, 'linkage')
      call table_new(made, rest, 1, table, facts, status)
      call demand(status == status_ok, 'table')
      call near(table%critical, reference%critical, 1.0e-12_wp, 'critical rotation')
      call near(facts%lock, reference%lock, 1.0e-9_wp, 'lock')
      do k = 0, 100
         q = 0.01_wp * k * table%limit
         call reference%coefficients(q, wanted(1), wanted(2), wanted(3), wanted(4), closed)
         call table%coefficients(q, found(1), found(2), found(3), found(4), closed)
         call near(found(1), wanted(1), 1.0e-11_wp, 'M')
         call demand(abs(found(2) - wanted(2)) <= 1.0e-10_wp * max(abs(wanted(2)), wanted(1) / table%limit), 'M''/2')
         call near(found(3) + facts%dv, wanted(3) + facts%dv, 1.0e-11_wp, 'V''')
         call near(found(4), wanted(4), 1.0e-11_wp, 'H')
         call near(table%potential(q) + facts%dv, reference%potential(q) + facts%dv, 1.0e-11_wp, 'V')
      end do
      call demand(facts%misfit < 1.0e-11_wp .and. facts%energy < 1.0e-9_wp, 'the check of the table')
      call demand(abs(table%potential(0.0_wp)) <= 0.0_wp, 'no potential at rest')

      call table_pack(table, list)
      call table_unpack(list, again, status)
      call demand(status == status_ok, 'unpack')
      call again%coefficients(q, wanted(1), wanted(2), wanted(3), wanted(4), closed)
      call demand(closed .and. all(abs(wanted - found) <= 0.0_wp), 'a packed table is the table')
      call again%coefficients(2.0_wp, wanted(1), wanted(2), wanted(3), wanted(4), closed)
      call demand(.not. closed, 'past the end of the table')

      parameters = [1.0_wp, 1.0_wp, list, list]
      call table_rocker_new(parameters, body, status)
      call demand(status == status_ok, 'a body that keeps all energy')
      parameters(1) = 1.001_wp
      call table_rocker_new(parameters, body, status)
      call demand(status /= status_ok, 'a body that gains energy was accepted')
      call table_new(made, rest, -1, table, facts, status)
      call demand(status /= status_ok, 'a mechanism that gravity opens to that side was accepted')
   end subroutine arch

   !> Links 2, 2 and 2.5 on a base of 4: the driver locks where the other two lie in line
   subroutine lock()
      real(wp) :: hinge(2, 4), mass(3), centroid(2, 3), start, cosine
      type(linkage) :: made
      type(linkage_state) :: rest, next
      type(side_table) :: table
      type(table_facts) :: facts
      integer(c_int) :: status

      start = 1.9_wp
      hinge(:, 1) = [0.0_wp, 0.0_wp]
      hinge(:, 2) = 2.0_wp * [cos(start), sin(start)]
      hinge(:, 4) = [4.0_wp, 0.0_wp]
      hinge(:, 3) = meet(hinge(:, 2), 2.5_wp, hinge(:, 4), 3.2_wp)
      ! A heavy driver that rises as it turns holds the mechanism shut up to the lock.
      mass = [100.0_wp, 1.0_wp, 1.0_wp]
      centroid = 0.5_wp * (hinge(:, 1:3) + hinge(:, 2:4))
      centroid(:, 1) = [3.0_wp, 1.0_wp]
      ! Unfolded BC and CD: |BD| = 5.7, cos of the driver's angle by the law of cosines
      cosine = (4.0_wp + 16.0_wp - 5.7_wp**2) / 16.0_wp
      call linkage_new(mass, centroid, [0.1_wp, 0.1_wp, 0.1_wp], &
         reshape([1_c_int, 0_c_int, 2_c_int, 1_c_int, 3_c_int, 2_c_int, 3_c_int, 0_c_int], [2, 4]), hinge, &
         reshape([1_c_int, 1_c_int, 1_c_int, 2_c_int, 2_c_int, 1_c_int, 2_c_int, 2_c_int, 3_c_int, 1_c_int, &
         3_c_int, 2_c_int, 4_c_int, 1_c_int, 4_c_int, 2_c_int], [2, 8]), 1_c_int, 1.0_wp, made, rest, status)
      call demand(status == status_ok, 'linkage that locks')
      call made%advance_state(rest, acos(cosine) - start - 1.0e-6_wp, next, status)
      call demand(next%closed, 'short of the lock')
      call made%advance_state(rest, acos(cosine) - start + 1.0e-6_wp, next, status)
      call demand(.not. next%closed, 'past the lock')
      call table_new(made, rest, -1, table, facts, status)
      call demand(status == status_ok, 'table up to the lock')
      call near(facts%lock, acos(cosine) - start, 1.0e-14_wp, 'lock in closed form')
      call demand(table%critical > 0.9999_wp * facts%lock .and. table%critical < facts%lock, 'balance')
      call near(table%limit, 0.999_wp * facts%lock, 1.0e-14_wp, 'limit short of the lock')
   end subroutine lock

   !> Intersection of two circles, the upper one
   pure function meet(one, r, two, s) result(point)
      real(wp), intent(in) :: one(2), r, two(2), s
      real(wp) :: point(2), d, x
      d = norm2(two - one)
      x = 0.5_wp * (d**2 + r**2 - s**2) / d
      point = one + (x * (two - one) + sqrt(r**2 - x**2) * [one(2) - two(2), two(1) - one(1)]) / d
   end function meet

   !> One block on a toe: closed forms
   subroutine block()
      type(linkage) :: made
      type(linkage_state) :: rest
      type(side_table) :: table
      type(table_facts) :: facts
      real(wp) :: q, found(4), alpha, radius
      integer(c_int) :: status
      integer :: k
      logical :: closed
      alpha = atan2(0.4_wp, 1.5_wp)
      radius = hypot(0.4_wp, 1.5_wp)
      call linkage_new([7.0_wp], reshape([0.0_wp, 1.5_wp], [2, 1]), [3.0_wp], reshape([1_c_int, 0_c_int], [2, 1]), &
         reshape([0.4_wp, 0.0_wp], [2, 1]), reshape([1_c_int, 1_c_int, 1_c_int, 2_c_int], [2, 2]), 1_c_int, -1.0_wp, &
         made, rest, status)
      call demand(status == status_ok, 'block')
      call table_new(made, rest, 1, table, facts, status)
      call demand(status == status_ok, 'table of the block')
      call near(table%critical, alpha, 1.0e-13_wp, 'critical rotation of the block')
      do k = -1, 60
         q = 0.03_wp * k * alpha
         call table%coefficients(q, found(1), found(2), found(3), found(4), closed)
         call near(found(1), 3.0_wp + 7.0_wp * radius**2, 1.0e-10_wp, 'M of the block')
         call near(1.0_wp + found(2) / found(1), 1.0_wp, 1.0e-8_wp, 'M'' of the block')
         call near(gravity + found(3), gravity * (1.0_wp + 7.0_wp * radius * sin(alpha - q)), 1.0e-10_wp, 'V'' block')
         call near(found(4), 7.0_wp * radius * cos(alpha - q), 1.0e-10_wp, 'H of the block')
      end do
   end subroutine block

   !> Impulses that do no work on the next mechanism, and never more energy than before
   subroutine impact()
      real(wp) :: mass(5), inertia(5), before(3, 5), after(3, 5), c_v
      integer :: k
      do k = 1, 50
         call random_number(mass)
         call random_number(inertia)
         call random_number(before)
         call random_number(after)
         before = before - 0.5_wp
         after = after - 0.5_wp
         c_v = projected_restitution(mass, inertia, before, after)
         call demand(abs(energy_product(mass, inertia, after, c_v * after + before)) < 1.0e-13_wp, 'impulses that work')
         call demand(c_v**2 * energy_product(mass, inertia, after, after) &
            <= energy_product(mass, inertia, before, before) * (1.0_wp + 1.0e-14_wp), 'energy from nowhere')
      end do
   end subroutine impact

   subroutine near(value, reference, tolerance, name)
      real(wp), intent(in) :: value, reference, tolerance
      character(len=*), intent(in) :: name
      if (abs(value - reference) <= tolerance * max(1.0e-300_wp, abs(reference))) return
      print '(a, 3es24.16)', name, value, reference, value - reference
      error stop 'differs'
   end subroutine near

   subroutine demand(holds, what)
      logical, intent(in) :: holds
      character(len=*), intent(in) :: what
      if (holds) return
      print '(a)', what
      error stop 'does not hold'
   end subroutine demand

end program test_mechanism
