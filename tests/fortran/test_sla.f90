!> Sequentially linear analysis without Python: teeth, and the event loop on a small cracking wall.
program test_sla
   use common_kinds, only : wp
   use common_status, only : status_ok
   use common_lists, only : element_q4 => sla_element_q4, law_linear => sla_law_linear
   use sla_events, only : run_events
   use sla_group, only : element_group, material_options
   use sla_handle, only : all_directions
   use sla_ledger, only : event_log, log_reals, log_integers
   use sla_model, only : element_model, model_new, model_add, model_prepare, model_factor, model_loads, model_free
   use sla_plane, only : plane_group, plane_group_new
   use sla_sawtooth, only : make_teeth
   use sla_state, only : monitor_set
   use sla_tables, only : tooth_tables, tooth_tables_new
   use, intrinsic :: iso_c_binding, only : c_int, c_int64_t
   implicit none (type, external)
   integer, parameter :: nx = 6, ny = 5
   real(wp) :: modulus(64), strength(64)
   integer(c_int) :: n, status

   call make_teeth(law_linear, 32.0e9_wp, 3.0e6_wp, 60.0_wp, 0.02_wp, 0.1_wp, .false., .true., n, modulus, strength, &
      status)
   if (status /= status_ok .or. n /= 16) error stop 'the ripple of the thesis beam has 16 teeth'
   if (abs(modulus(16) - 333.48e6_wp) > 0.01e6_wp) error stop 'the last tooth is wrong'
   call wall()

contains

   !> A plate pulled at one side cracks; the energy balance holds after each event
   subroutine wall()
      type(element_model) :: model
      type(material_options) :: options
      type(tooth_tables) :: teeth
      type(plane_group), allocatable :: plane
      class(element_group), allocatable :: group
      type(monitor_set) :: monitors
      type(event_log) :: log
      real(wp) :: xy(2, (nx + 1) * (ny + 1)), factor(2, (nx + 1) * (ny + 1)), load(2, (nx + 1) * (ny + 1))
      integer(c_int) :: equation(2, (nx + 1) * (ny + 1)), connect(4, nx * ny), bad, row, node, direction, reason
      integer(c_int), allocatable :: nodes(:, :), directions(:, :)
      integer(c_int) :: choice(5, nx * ny)
      real(wp) :: property(14, nx * ny), ratio, gap
      integer :: i, j, k, e

      do i = 0, nx
         do j = 0, ny
            k = i * (ny + 1) + j + 1
            xy(:, k) = [0.11_wp * real(i, wp), 0.13_wp * real(j, wp)]
            equation(:, k) = merge(0_c_int, int([2 * k - 1, 2 * k] - 2 * (ny + 1), c_int), i == 0)
            load(:, k) = 0.0_wp
            if (i == nx) load(1, k) = 1.0_wp
            if (i == nx) load(2, k) = 0.23_wp * real(j, wp)
         end do
      end do
      e = 0
      do i = 0, nx - 1
         do j = 1, ny
            e = e + 1
            k = i * (ny + 1) + j
            connect(:, e) = int([k, k + ny + 1, k + ny + 2, k + 1], c_int)
         end do
      end do
      factor = 1.0_wp
      call model_new(xy, equation, 0_c_int, factor, options, model, status)
      if (status /= status_ok) error stop 'no element_model'
      call tooth_tables_new(reshape([1.0_wp, 7.0e9_wp, 0.3e6_wp, 47.0_wp, 0.17_wp, 0.2_wp, 1.0_wp, 1.0_wp], [8, 1]), &
         teeth, row, status)
      if (status /= status_ok) error stop 'no teeth'
      allocate (plane)
      property = 0.0_wp
      property(1:3, :) = spread([0.21_wp, 7.0e9_wp, 0.19_wp], 2, nx * ny)
      choice = 0
      choice(1, :) = 1
      call plane_group_new(element_q4, 2_c_int, 2_c_int, .false., xy, connect, property, choice, teeth, options, &
         plane, bad, status)
      if (status /= status_ok) error stop 'no elements'
      call move_alloc(plane, group)
      call all_directions(connect, 2, nodes, directions, status)
      if (status == status_ok) call model_add(model%mesh, group, nodes, directions, status)
      if (status == status_ok) call model_prepare(model, 0_c_int, huge(1_c_int64_t), status)
      if (status == status_ok) call model_factor(model, node, direction, ratio, status)
      if (status == status_ok) call model_loads(model, 0.0_wp * load, load, .false., status)
      if (status /= status_ok) error stop 'no factor'
      allocate (log%reals(log_reals, 600), log%integers(log_integers, 600), log%monitors(1, 600))
      monitors = monitor_set([1_c_int, 2_c_int], [model%mesh%equation(1, size(xy, 2))], [1.0_wp], [0.0_wp])
      call run_events(model, monitors, log, reason, status)
      if (status /= status_ok .or. log%count < 100) error stop 'the events stopped too early'
      gap = maxval(abs(log%reals(5, 1:log%count) - log%reals(4, 1:log%count) - log%reals(6, 1:log%count))) &
         / maxval(log%reals(5, 1:log%count))
      print '(a, i0, a, es9.2)', 'energy balance after ', log%count, ' events', gap
      if (.not. gap < 1.0e-10_wp) error stop 'the energy balance does not hold'
      call model_free(model)
   end subroutine wall

end program test_sla
